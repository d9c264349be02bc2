// Results beside the form: numbers after every change, then figure, sliders and curves; runs in the background.
//   hears truing:state ({text}) of edit.js; says truing:shown ({text}) once the numbers of a text are there

import { call, Faults, listen, say } from "./workbench.js";
import { change, save, textNow } from "./edit.js";

const page = document.getElementById("edit");
const about = { file: page.dataset.file, plugin: page.dataset.plugin };
const asker = { page: `${performance.timeOrigin} ${Math.random()}` }; // a newer question of this page ends an older one
const at = (name) => document.getElementById(`see-${name}`);

function made(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

// An answer about the text; what is wrong with the text is thrown.
async function asked(address, body) {
  const answer = await call(address, { ...about, ...asker, ...body });
  if (answer.faults) throw new Faults(answer.faults);
  return answer;
}

function put(element, text) { if (element.textContent !== text) element.textContent = text; }

// Work of which one goes on at a time; of what comes meanwhile the newest is done next.
function newest(work) {
  let busy = false, next = null;
  return async (...given) => {
    next = given;
    if (busy) return;
    busy = true;
    try { while (next) { const now = next; next = null; await work(...now); } } finally { busy = false; }
  };
}

function soon(work, wait) {
  let timer;
  return (...given) => { clearTimeout(timer); timer = setTimeout(() => work(...given), wait); };
}

// Parts of the page that have the style of sheets, and only that

function apart(host) {
  const root = host.attachShadow({ mode: "open" }), inner = made("div");
  for (const href of ["/sheet.css", "/static/live.css"]) root.append(made("link", { rel: "stylesheet", href }));
  root.append(inner);
  return inner;
}

const front = apart(at("numbers")), sections = apart(at("sections"));
const drawing = apart(at("drawing")), curves = apart(at("curves"));

// Bring a part to what a new one says; what is equal stays, so that nothing that is open or chosen is lost.
function follow(old, fresh) {
  const before = [...old.childNodes], after = [...fresh.childNodes];
  after.forEach((node, index) => {
    const known = before[index];
    if (!known) old.append(node);
    else if (known.nodeName !== node.nodeName) known.replaceWith(node);
    else if (node.nodeType !== Node.ELEMENT_NODE) { if (known.data !== node.data) { known.data = node.data; moved(known.parentElement); } }
    else {
      if (known.className !== node.className && !standing.has(known)) known.className = node.className;
      const title = node.getAttribute("data-title"); // the head of the column, where cells stand below one another
      if (title === null) known.removeAttribute("data-title"); else known.setAttribute("data-title", title);
      follow(known, node);
    }
  });
  for (const rest of before.slice(after.length)) rest.remove();
}

// Let numbers that changed stand out for a while: two changes of colour for all of them, nothing that moves.
const standing = new Set();
let settles;
function moved(element) {
  const cell = element?.closest("td");
  if (!cell) return;
  cell.classList.add("moved");
  standing.add(cell);
  clearTimeout(settles);
  settles = setTimeout(() => { for (const each of standing) each.classList.remove("moved"); standing.clear(); }, 1500);
}

// Numbers: one question at a time, the newest next; where a model hangs, one more beside it. Late answers are dropped.

const SLOW = 700, HANGS = 1500, MOST = 2; // ms until the page says that it waits, and until one more is asked; questions
let shown = null, failed = "", isSlow = false;
let wanted = null, asking = 0, began = 0, latest = 0, answered = 0;

function numbers(text) { wanted = text; next(); }

function next() {
  if (wanted === null || asking >= MOST) return;
  const wait = asking ? began + HANGS - performance.now() : 0;
  if (wait > 0) { setTimeout(next, wait + 1); return; }
  const text = wanted;
  wanted = null;
  asking += 1;
  began = performance.now();
  numbered(text, latest += 1).finally(() => { asking -= 1; next(); });
}

async function numbered(text, number) {
  const beside = at("beside").value, slow = setTimeout(() => waits(number), SLOW);
  let answer = null, fault = "";
  try { answer = await asked("/api/numbers", { text, run: beside }); } catch (error) {
    if (error.overtaken) return;
    fault = sentence(error);
  } finally { clearTimeout(slow); }
  if (number < answered) return;
  answered = number;
  failed = fault;
  isSlow = false;
  if (answer) { written(answer); shown = text; }
  const differ = !answer || answer.changed === null ? "" : ` ${answer.changed || "No"} result${answer.changed === 1 ? " differs" : "s differ"} from ${beside}.`;
  tells(answer ? `${answer.headline}.${differ}` : failed, !answer || differ);
  marked();
  document.dispatchEvent(new CustomEvent("truing:shown", { detail: { text, failed } }));
}

function waits(number) {
  if (number < latest) return;
  isSlow = true;
  tells("Calculating …", true);
  marked();
}

function written(answer) {
  const fresh = made("template", { innerHTML: answer.html }).content, rest = fresh.querySelector(".sections");
  rest.remove();
  follow(front, fresh);
  follow(sections, rest);
}

// Say what became of the text; where the numbers say it as well, for screen readers alone.
function tells(words, isSeen) {
  put(at("said"), words);
  at("said").classList.toggle("hidden", !isSeen);
  at("said").classList.toggle("bad", failed !== "" && !isSlow);
}

function sentence(error) {
  const [first, ...more] = error.faults ?? [{ message: error.message }];
  const where = first.line ? `Line ${first.line}: ` : "";
  const others = more.length ? ` (and ${more.length} more)` : "";
  return `${where}${first.message}${others}`;
}

// What is on the page may be of an earlier text: after a fault, or while the model is calculating.
function marked() {
  const stale = shown !== null && (failed !== "" || isSlow);
  at("mark").hidden = !stale;
  for (const name of ["numbers", "sections", "drawing"]) at(name).classList.toggle("stale", stale);
}

// What takes longer follows once the numbers are there

const slower = newest(async (text) => {
  if (text !== shown) return;
  await drawn(text);
  await dragged(text);
  await lastRun(text);
});
const follows = soon((text) => slower(text), 350);

async function drawn(text) {
  try {
    const { svg, caption } = await asked("/api/figure", { text });
    at("figure").hidden = !svg;
    drawing.replaceChildren(made("div", { className: "drawing", innerHTML: svg }));
    put(at("caption"), caption);
  } catch { at("figure").hidden = true; }
}

document.addEventListener("truing:state", ({ detail }) => numbers(detail.text));
document.addEventListener("truing:shown", ({ detail }) => { if (!detail.failed) follows(detail.text); else checked(detail.text); });

// Sliders

const inputs = new Map(), sliders = new Map();
const AHEAD = 1000; // ms for which a slider that was moved stays where it is, whatever comes of an earlier text
let dragging = false;
const moving = newest(async ({ name, unit }, value) => {
  dragging = true;
  try { await change(["inputs", name], unit ? `${value} ${unit}` : Number(value)); } finally { dragging = false; }
});

async function dragged(text) {
  let answer;
  const first = inputs.size === 0;
  try { answer = await asked("/api/sliders", { text, ranked: first }); } catch { return; }
  for (const input of answer.inputs) inputs.set(input.name, { ...inputs.get(input.name), ...input, why: input.why || inputs.get(input.name)?.why || "" });
  if (first) offered(answer.most);
  if (dragging || text !== textNow()) return;  // the sliders are ahead of this text
  for (const [name, slider] of sliders) placed(inputs.get(name), slider);
}

function offered(most) {
  for (const name of most) addSlider(name);
  const named = (input) => made("option", { value: input.name, textContent: input.note === input.name ? input.name : `${input.note} (${input.name})` });
  at("add").append(...[...inputs.values()].map(named));
  at("over").append(...[...inputs.values()].sort((a, b) => rank(most, a) - rank(most, b)).map(named));
  ends();
}

function rank(most, input) { const place = most.indexOf(input.name); return place < 0 ? most.length : place; }

function addSlider(name) {
  if (sliders.has(name)) return;
  const input = inputs.get(name), ident = `see-slider-${name}`;
  const range = made("input", { type: "range", id: ident, min: input.low, max: input.high, step: input.step });
  const output = made("output"), why = made("p", { className: "quiet why", textContent: input.why, id: `${ident}-why` });
  output.setAttribute("for", ident);
  range.setAttribute("aria-describedby", why.id);
  const label = made("label", { textContent: input.note, htmlFor: ident });
  const slider = { range, output, unit: input.unit, movedAt: -Infinity };
  range.addEventListener("input", () => {
    const { unit, printed } = inputs.get(name);
    if (unit !== slider.unit) return; // the text states another unit meanwhile: the slider takes it over first
    slider.movedAt = performance.now();
    put(output, `${range.value} ${printed}`);
    moving({ name, unit }, range.value);
  });
  at("sliders").append(made("div", { className: "see-slider" }, label, output, range, why));
  sliders.set(name, slider);
  placed(input, slider);
}

// Bring a slider to where its input stands; it gets other ends where the input lies outside of them, or has another unit.
function placed(input, slider) {
  const { range, output, unit, movedAt } = slider;
  clearTimeout(slider.later);
  if (range.matches(":active") || performance.now() - movedAt < AHEAD) { // it is ahead of what is answered
    slider.later = setTimeout(() => placed(inputs.get(input.name), slider), AHEAD);
    return;
  }
  const isOutside = input.value < Number(range.min) || input.value > Number(range.max);
  if (isOutside || unit !== input.unit) Object.assign(range, { min: input.low, max: input.high, step: input.step });
  slider.unit = input.unit;
  range.value = input.value;
  put(output, `${input.value} ${input.printed}`);
}

at("add").addEventListener("change", () => {
  const name = at("add").value;
  if (name) { addSlider(name); document.getElementById(`see-slider-${name}`).focus(); }
  at("add").value = "";
});

// Curves along an input

function ends() {
  const input = inputs.get(at("over").value);
  if (!input) return;
  for (const [name, value] of [["low", input.low], ["high", input.high]]) {
    Object.assign(at(`${name}-drag`), { min: input.low, max: input.high, step: input.step, value });
    at(`${name}-drag`).value = value;
    at(name).value = `${value} ${input.unit}`.trim();
  }
}

const sweep = newest(async () => {
  const over = at("over").value;
  if (!over || !at("along").open) return;
  put(at("swept"), "Calculating …");
  try {
    const { svg, said } = await asked("/api/sweep", { text: textNow(), over, low: at("low").value, high: at("high").value });
    curves.replaceChildren(made("div", { className: "drawing", innerHTML: svg }));
    at("met").replaceChildren(...said.map((text) => made("li", { textContent: text })));
    put(at("swept"), "");
    at("swept").classList.remove("bad");
  } catch (error) { put(at("swept"), sentence(error)); at("swept").classList.add("bad"); }
  document.dispatchEvent(new CustomEvent("truing:swept"));
});
const sweeps = soon(sweep, 200);

at("over").addEventListener("change", () => { ends(); sweeps(); });
at("along").addEventListener("toggle", sweeps);
for (const name of ["low", "high"]) {
  at(name).addEventListener("input", sweeps);
  at(`${name}-drag`).addEventListener("input", () => {
    at(name).value = `${at(`${name}-drag`).value} ${inputs.get(at("over").value).unit}`.trim();
    sweeps();
  });
}
at("sweep").addEventListener("submit", (event) => event.preventDefault());
document.addEventListener("truing:shown", ({ detail }) => { if (!detail.failed) sweeps(); });

// Runs: in the background, and the last one beside the text

let job = null, dated = "";

async function run() {
  try {
    if (!await save()) return;
    job = await call("/api/run", about);
    followed([job]);
  } catch (error) { say(error.message); }
}
document.getElementById("run").onclick = run;
at("cancel").onclick = () => call("/api/cancel", { job: job.ident }).catch((error) => say(error.message));

function followed(jobs) {
  const own = jobs.filter((each) => each.name === "runs.run" && each.about === about.file);
  const now = own.find((each) => ["waits", "runs"].includes(each.status)) ?? own.find((each) => each.ident === job?.ident);
  const goes = now !== undefined && ["waits", "runs"].includes(now.status);
  at("job").hidden = !goes;
  if (goes) {
    job = now;
    put(at("stage"), now.status === "waits" ? "waits for its turn" : now.stage.replaceAll("_", " "));
    if (now.total) at("progress").value = now.done / now.total; else at("progress").removeAttribute("value");
  } else if (now !== undefined && job !== null) {
    job = null;
    ended(now);
  }
}

async function ended(now) {
  if (now.status === "done") numbers(textNow());  // the run may have decided what only its studies do
  await lastRun(textNow());
  const faults = now.faults.map((fault) => fault.message).join(" ");
  if (now.status === "failed") put(at("last"), `The run ended without results: ${faults}`);
  if (now.status === "cancelled") put(at("last"), "The run was cancelled. Nothing was written.");
}

async function lastRun(text) {
  let answer;
  try { answer = await asked("/api/last", { text }); } catch { return; }
  comparable(answer.runs);
  at("older").hidden = !answer.run || !answer.older;
  at("differences").replaceChildren(...(answer.differences ?? []).map((text) => made("li", { textContent: text })));
  if (!answer.run) { put(at("last"), "No run of this file yet. Run it to see its studies."); at("chapters").replaceChildren(); dated = ""; return; }
  const { name, date, verdict } = answer.run;
  put(at("last"), `Run of ${date}: ${verdict}.`);
  if (answer.older) at("last").append(" The text now states:");
  if (dated === `${name} ${date}` && at("chapters").children.length) return;
  dated = `${name} ${date}`;
  const open = new Set([...at("chapters").querySelectorAll("details[open] > summary")].map((each) => each.textContent));
  const link = made("a", { href: `/file/${name.split("/").map(encodeURIComponent).join("/")}/sheet.html`, textContent: "Sheet of this run" });
  at("chapters").replaceChildren(link, ...answer.chapters.map((chapter) => folded(chapter, name, open.has(chapter.title))));
}
const checked = soon((text) => lastRun(text), 400);

function folded({ ident, title }, name, open) {
  const details = made("details", {}, made("summary", { textContent: title }));
  details.addEventListener("toggle", async () => {
    if (!details.open || details.querySelector("iframe")) return;
    try { details.append(framed((await call("/api/chapter", { run: name, ident })).html, title)); } catch (error) { say(error.message); }
  });
  details.open = open;
  return details;
}

// A page in a frame in which nothing runs; a chapter is as high as what it shows.
function framed(html, title, fits = true) {
  const frame = made("iframe", { title, srcdoc: html });
  frame.setAttribute("sandbox", "allow-same-origin");
  if (fits) frame.addEventListener("load", () => {
    const fit = () => { frame.style.height = `${frame.contentDocument.documentElement.scrollHeight + 4}px`; };
    fit();
    frame.contentDocument.addEventListener("toggle", fit, true);
  });
  return frame;
}

function comparable(runs) {
  const chosen = at("beside").value, known = [...at("beside").options].map((option) => option.value).slice(1);
  if (known.join("\n") === runs.map((each) => each.name).join("\n")) return;
  const options = runs.map((each) => made("option", { value: each.name, textContent: [each.name, each.date, each.verdict].filter(Boolean).join(" · ") }));
  at("beside").replaceChildren(at("beside").options[0], ...options);
  at("beside").value = runs.some((each) => each.name === chosen) ? chosen : "";
}
at("beside").addEventListener("change", () => numbers(textNow()));

// The whole sheet, as it would be without studies

at("whole").addEventListener("toggle", async () => {
  at("whole").querySelector("iframe")?.remove();
  if (!at("whole").open) return;
  put(at("whole-said"), "Writing the sheet …");
  try {
    at("whole").append(framed((await asked("/api/whole", { text: textNow() })).html, "Sheet of this text", false));
    put(at("whole-said"), "");
  } catch (error) { put(at("whole-said"), sentence(error)); }
});

listen(about.file, (seen) => followed(seen.jobs));
numbers(textNow());
lastRun(textNow());
