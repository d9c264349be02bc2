// The page of measured files: taking them in, what their columns are, what is wrong with them, and what explains them.
import { ask, call, Faults, listen, made, say, tell } from "./workbench.js";
import { planShown, watched } from "./experiment.js";

const page = document.getElementById("measure"), files = document.getElementById("files");
const about = { file: page.dataset.file, plugin: page.dataset.plugin };
const chosen = JSON.parse(page.dataset.chosen);
let text = JSON.parse(page.dataset.text), saved = { text, digest: page.dataset.digest };
const own = about.plugin.endsWith(".py") ? [["plugin", about.plugin]] : [];  // a calculation in a file of the folder
let changes = [], answer = null, turn = 0, known = null;

// Files

const drop = document.getElementById("drop"), upload = document.getElementById("upload"), lying = document.getElementById("lying");
upload.addEventListener("change", async () => { await takeIn([...upload.files]); upload.value = ""; });
for (const name of ["dragenter", "dragover"]) drop.addEventListener(name, (event) => { event.preventDefault(); drop.classList.add("is-over"); });
for (const name of ["dragleave", "drop"]) drop.addEventListener(name, () => drop.classList.remove("is-over"));
drop.addEventListener("drop", (event) => { event.preventDefault(); takeIn([...event.dataTransfer.files]); });

async function takeIn(several) {
  for (const file of several) {
    try {
      const name = await sent(file);
      if (!name) continue;
      if (!chosen.includes(name)) chosen.push(name);
      listed(name);
    } catch (error) { say(error.message); }
  }
  refresh();
}

async function sent(file, replace = "") {
  tell(`${file.name} is taken in …`);
  const address = `/api/upload?name=${encodeURIComponent(file.name)}${replace}`;
  const reply = await fetch(address, { method: "POST", headers: { "content-type": "application/octet-stream" }, body: file });
  const said = await reply.json();
  if (said.exists) {
    const other = `${said.file} is there already and holds something else.\nReplace it?`;
    return await ask(other, "Replace it", "Keep it as it is") ? sent(file, "&replace=yes") : null;
  }
  if (!reply.ok) throw new Faults(said.faults);
  tell(`${said.file} is there`);
  return said.file;
}

function listed(name) {
  const box = [...lying.querySelectorAll("input")].find((each) => each.value === name);
  if (box) { box.checked = true; return; }
  lying.hidden = false;
  lying.append(made("label", { className: "pick" }, made("input", { type: "checkbox", name: "data", value: name, checked: true }), ` ${name}`));
}

lying.addEventListener("change", (event) => {
  const name = event.target.value;
  if (event.target.checked) chosen.push(name); else chosen.splice(chosen.indexOf(name), 1);
  refresh();
});

// What the files hold

async function refresh(...more) {
  const query = new URLSearchParams([["file", about.file], ...own, ...chosen.map((name) => ["data", name])]);
  history.replaceState(null, "", `/measure?${query}`);
  const mine = ++turn;
  if (!chosen.length) { files.replaceChildren(made("p", { className: "empty", textContent: "No file is chosen yet. Its columns and its first rows will stand here." })); shown(null); return; }
  files.setAttribute("aria-busy", "true");
  try {
    const said = await call("/api/columns", { ...about, text, data: chosen, changes: more });
    changes.push(...more);
    text = said.text;
    if (mine !== turn) return;
    shown(said);
  } catch (error) { if (mine === turn) say(error.message); }
  files.setAttribute("aria-busy", "false");
}

function shown(said) {
  answer = said;
  document.getElementById("faults").replaceChildren(...(said?.faults ?? []).map(faultLine));
  if (said) {
    const focused = document.activeElement?.id;
    files.replaceChildren(...said.files.map(fileShown));
    document.getElementById(focused)?.focus();
  }
  const guesses = said ? said.files.flatMap((file) => file.columns).filter((column) => column.guess).length : 0;
  document.getElementById("tools").hidden = !said;
  const all = document.getElementById("confirm-all");
  all.hidden = !guesses;
  all.textContent = guesses === 1 ? "Confirm the guess" : `Confirm all ${guesses} guesses`;
  document.getElementById("keep").disabled = text === saved.text;
  document.getElementById("kept").textContent = text === saved.text ? "" : "The columns are not kept yet.";
  document.getElementById("competing").hidden = !said;
  if (said) compete();
}

function faultLine(fault) {
  const at = [fault.file, fault.line].filter(Boolean).join(":");
  return made("li", {}, at ? `${at}: ` : "", fault.message);
}

function fileShown(file, number) {
  const section = made("section", { className: "panel" });
  section.setAttribute("aria-labelledby", `file-${number}`);
  const wrong = file.wrong.length + file.more;
  const title = made("h2", { id: `file-${number}`, textContent: file.name });
  const count = made("p", { className: "quiet", textContent: [file.rows && !file.notes.some((note) => note.startsWith(`${file.rows} rows`)) ? `${file.rows} rows` : "", ...file.notes].filter(Boolean).join("; ") });
  section.append(title, count, made("ul", { className: "faults" }, ...file.faults.map(faultLine)));
  if (file.columns.some((column) => column.guess)) section.append(made("p", { className: "note", textContent: "What a column may be is guessed below from its name and unit. A guess counts once you confirm it." }));
  if (!file.columns.length) return section;
  if (wrong) section.append(wrongRows(file, wrong));
  section.append(columnsTable(file, number), figureOf(file, number));
  section.append(made("details", { open: !wrong }, made("summary", { textContent: "First rows" }), cellsTable(file, file.first)));
  return section;
}

function scrolling(table, of) { const box = made("div", { className: "scroll", tabIndex: 0 }, table); box.setAttribute("role", "region"); box.setAttribute("aria-label", `${table.caption?.textContent ?? "First rows"}: ${of}`); return box; }

function heads(titles, isNumber) { return made("thead", {}, made("tr", {}, ...titles.map((title, index) => made("th", { scope: "col", className: isNumber(index) ? "number" : "", textContent: title })))); }

// Rows as they are written; wrong ones say why, and on a phone show nothing but the cells that are.
function cellsTable(file, rows, caption = "") {
  const hasReasons = rows.some((row) => row.reasons), ahead = hasReasons ? 2 : 1;
  const isNumber = (index) => file.columns[index]?.values > 0;
  const body = rows.map((row) => made("tr", { className: row.reasons ? "wrong" : "" },
    named(made("th", { scope: "row", textContent: row.line }), hasReasons ? "Line" : ""),
    ...(hasReasons ? [made("td", { className: "reason bad", textContent: row.reasons.join("; ") })] : []),
    ...row.cells.map((cell, index) => named(made("td", { className: `${isNumber(index) ? "number" : ""} ${row.bad?.includes(index) ? "bad" : ""}`.trim(), textContent: cell }), hasReasons ? file.columns[index]?.text : ""))));
  const titles = ["Line", ...(hasReasons ? ["What is wrong"] : []), ...file.columns.map((column) => column.text)];
  const parts = [...(caption ? [made("caption", { textContent: caption })] : []), heads(titles, (index) => isNumber(index - ahead)), made("tbody", {}, ...body)];
  return scrolling(made("table", { className: hasReasons ? "cells stacked" : "cells" }, ...parts), file.name);
}

// Name a cell for the phone, where no head of a column stands above it.
function named(cell, label) { if (label) cell.dataset.label = label; return cell; }

function wrongRows(file, count) {
  const more = file.more ? `, the first ${file.wrong.length} of them` : "";
  return cellsTable(file, file.wrong, `${count === 1 ? "One row is" : `${count} rows are`} wrong${more}`);
}

// Columns

function columnsTable(file, number) {
  const rows = file.columns.map((column) => made("tr", {},
    made("th", { scope: "row", textContent: column.text }),
    made("td", {}, roleOf(column, number), guessOf(column)),
    named(made("td", {}, unitOf(column, number)), "Unit"),
    named(made("td", { className: "number", textContent: column.values }), "Numbers"),
    named(made("td", { className: "number", textContent: column.low === null ? "" : column.low === column.high ? column.low : `${column.low} … ${column.high}` }), column.low === null ? "" : "From … to")));
  return scrolling(made("table", { className: "file-columns stacked" }, made("caption", { textContent: "Columns" }),
    heads(["As written", "Is to the model", "Unit", "Numbers", "From … to"], (index) => index > 2), made("tbody", {}, ...rows)), file.name);
}

function roleOf(column, number) {
  const select = made("select", { id: `role-${number}-${column.index}` });
  select.setAttribute("aria-label", `${column.text} is to the model`);
  select.append(made("option", { value: "", textContent: "nothing of the model (an error may depend on it)" }), made("option", { value: "run", textContent: "run label" }));
  const alike = quantities().filter((each) => each.name in column.of_this_unit);
  for (const { group, of } of [...(alike.length ? [{ group: `In ${Object.values(column.of_this_unit)[0]}`, of: alike }] : []), ...answer.roles]) {
    select.append(made("optgroup", { label: group }, ...of.map((each) => made("option", { value: each.name, title: each.note, textContent: each.name }))));
  }
  select.value = column.role === "other" ? "" : column.name;
  select.onchange = () => {
    const name = select.value;
    const own = column.text.replace(/ *\[.*\]$/, "");
    if (!name) return refresh({ key: column.key, name: column.stated && own !== column.name ? null : `other_${own}` });
    const unit = column.unit ?? column.of_this_unit[name] ?? unitDeclared(name);
    return refresh({ key: column.key, name, unit: column.text.includes("[") && !column.stated ? "" : unit });
  };
  return select;
}

function quantities() { return answer.roles.flatMap(({ of }) => of); }
function unitDeclared(name) { return quantities().find((each) => each.name === name)?.unit ?? ""; }

function unitOf(column, number) {
  const input = made("input", { id: `unit-${number}-${column.index}`, value: column.unit ?? "", size: 9, spellcheck: false, autocomplete: "off", placeholder: column.declared });
  input.setAttribute("aria-label", `unit of ${column.text}`);
  input.disabled = column.role === "run";
  input.onchange = () => refresh({ key: column.key, name: column.name, unit: input.value.trim() });
  return input;
}

function guessOf(column) {
  if (!column.guess) return "";
  const { name, unit } = column.guess, words = [name === column.name ? "" : name, unit].filter(Boolean).join(", ");
  const button = made("button", { type: "button", textContent: "Confirm", onclick: () => refresh(confirmed(column)) });
  button.setAttribute("aria-label", `Confirm that ${column.text} is ${words}`);
  return made("div", { className: "guess" }, made("span", { className: "badge undecided", textContent: "guess" }), made("span", { textContent: words }), button);
}

function confirmed(column) { return { key: column.key, name: column.guess.name, unit: column.guess.unit }; }

document.getElementById("confirm-all").onclick = () => {
  const guessed = answer.files.flatMap((file) => file.columns).filter((column) => column.guess);
  refresh(...new Map(guessed.map((column) => [column.key, confirmed(column)])).values());
};

// The figure of a column

const drawn = new Map();
function figureOf(file, number) {
  const numeric = file.columns.filter((column) => column.values > 1);
  if (!numeric.length) return "";
  const now = drawn.get(file.name) ?? {};
  const select = (ident, label, options, value) => {
    const element = made("select", { id: `${ident}-${number}` }, ...options.map(([each, name]) => made("option", { value: each, textContent: name })));
    element.value = value;
    element.onchange = draw;
    return [made("label", { htmlFor: element.id, textContent: label }), element];
  };
  const names = numeric.map((column) => [column.index, column.text]);
  const [showLabel, show] = select("show", "Show", names, now.shown ?? file.figure.shown);
  const [overLabel, over] = select("over", "over", [[-1, "the rows"], ...names], now.over ?? -1);
  const place = made("div", { className: "figure" }), root = place.attachShadow({ mode: "open" });
  const put = (svg) => { root.innerHTML = `<style>${FIGURE}</style>${svg || "<p>nothing to be drawn</p>"}`; };
  async function draw() {
    const asked = { shown: Number(show.value), over: Number(over.value) };
    drawn.set(file.name, asked);
    try {
      const said = await call("/api/column-figure", { ...about, text, of: file.name, ...asked });
      put(said.svg);
    } catch (error) { root.textContent = error.message; }
  }
  if (drawn.has(file.name)) draw(); else put(file.figure.svg);
  return made("div", {}, made("div", { className: "figure-of" }, showLabel, show, overLabel, over), place);
}

const FIGURE = `svg { width: 100%; height: auto; font: 12px system-ui, sans-serif; fill: currentColor; color: var(--ink); }
  path { fill: none; stroke: var(--accent); stroke-width: 1.4; vector-effect: non-scaling-stroke; }
  .points { stroke-width: 4; stroke-linecap: round; } .axis { stroke: var(--edge); } .grid { stroke: var(--line); stroke-width: 1; } .wrong { stroke: var(--bad); stroke-width: 2; }
  @media (max-width: 48rem) { svg { font-size: 19px; } }`;

// Kept in the inputs file, without losing what another hand has written there

async function keep() {
  if (text === saved.text) return;
  const said = await call("/api/save", { file: about.file, text, base: saved.digest });
  if (said.conflict) {
    const again = changes;
    if (await readAnew()) await refresh(...again);
    tell(`${about.file} had been changed; your columns are now in what is there`);
    return keep();
  }
  saved = { text, digest: said.digest };
  changes = [];
  document.getElementById("keep").disabled = true;
  document.getElementById("kept").textContent = `kept in ${about.file}`;
}
// Take over what the file says now; false where it is gone, and saving writes it again.
async function readAnew() {
  const seen = await call("/api/read", { file: about.file, text });
  if (seen.gone) { saved = { text: "", digest: seen.digest }; return false; }
  text = seen.text;
  saved = { text, digest: seen.digest };
  changes = [];
  return true;
}
document.getElementById("keep").onclick = () => keep().catch((error) => say(error.message));
addEventListener("beforeunload", (event) => { if (text !== saved.text) event.preventDefault(); });

// Diagnose

document.getElementById("diagnose").onclick = () => diagnose(causesOn());
document.getElementById("try").onclick = () => diagnose([document.getElementById("suspicion").value]);

async function diagnose(causes) {
  try {
    await keep();
    const job = await call("/api/diagnose", { ...about, data: chosen, causes });
    tell("The diagnosis runs; you may go on or close this page, its folder stays.");
    watched(job.ident, (done) => {
      const query = new URLSearchParams([["folder", done.folder], ["file", about.file], ...own, ...chosen.map((name) => ["data", name])]);
      location.href = `/measure/diagnosis?${query}`;
    });
  } catch (error) { say(error.message); }
}

function causesOn() {
  const boxes = [...document.querySelectorAll("#candidate-list input")];
  return boxes.every((box) => box.checked) ? [] : boxes.filter((box) => box.checked).map((box) => box.value);
}

const KINDS = { effect: "Effects of the model", gauge: "What a gauge may show", input: "Inputs outside of their tolerance", unknown: "Not registered" };

async function compete() {
  if (!known) await offered();
  if (!known || !answer) return;
  for (const column of answer.files.flatMap((file) => file.columns)) if (column.role === "measured") addNoise(column.name);
}

async function offered() {
  try { known ??= await call("/api/candidates", { ...about, text }); } catch (error) { return; }
  if (more.options.length > 1) return;
  const suspicion = document.getElementById("suspicion"), list = document.getElementById("candidate-list"), plan = document.getElementById("plan-causes");
  const titles = known.candidates.map((each) => each.title);
  for (const each of known.candidates) if (titles.filter((title) => title === each.title).length > 1) each.title += ` (${each.name})`;
  for (const [kind, title] of Object.entries(KINDS)) {
    const several = known.candidates.filter((each) => each.kind === kind);
    if (!several.length) continue;
    const tick = (each, name, checked) => made("label", { title: each.about ?? "" }, made("input", { type: "checkbox", name, value: each.name, checked }), ` ${each.title}`);
    const isOn = (each) => !known.causes.length || known.causes.includes(each.name);
    list.append(made("fieldset", {}, made("legend", { textContent: title }), made("div", { className: "ticks" }, ...several.map((each) => tick(each, "cause", isOn(each))))));
    if (kind === "unknown") continue;
    suspicion.append(made("optgroup", { label: title }, ...several.map((each) => made("option", { value: each.name, textContent: each.title }))));
    plan.append(...several.map((each) => tick(each, "plan", false)));
  }
  more.append(...known.results.map(({ name }) => made("option", { value: name, textContent: name })));
}

// How well a reading is known: of every result that is measured, and of those that are chosen beyond.
const more = document.getElementById("plan-more"), noises = document.getElementById("plan-noise");

function addNoise(name) {
  const result = known.results.find((each) => each.name === name), box = `noise:${name}`;
  if (!result) return null;
  const there = noises.querySelector(`[name="${CSS.escape(box)}"]`);
  if (there) return there;
  const input = made("input", { name: box, placeholder: result.unit ? `1 ${result.unit}` : "1", spellcheck: false });
  noises.append(made("label", { className: "field" }, `Standard deviation of one reading of ${name}`, input));
  return input;
}
more.onchange = () => { if (more.value) addNoise(more.value)?.focus(); more.value = ""; };

document.getElementById("plan-form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const form = new FormData(event.target), noise = {};
  for (const [name, value] of form) if (name.startsWith("noise:") && value.trim()) noise[name.slice(6)] = value.trim();
  try {
    const causes = form.getAll("plan");
    if (causes.length < 2) throw new Error("Choose two causes or more that are to be told apart.");
    const job = await call("/api/plan", { ...about, causes, noise, budget: Number(form.get("budget")) });
    watched(job.ident, (done) => planShown(document.getElementById("plan"), done.experiment, done.sentences));
  } catch (error) { say(error.message); }
});

let following = false;
listen(about.file, async ({ digest }) => {
  if (following || !digest || digest === saved.digest || text !== saved.text) return;
  following = true;
  try {
    if (await readAnew()) { await refresh(); tell(`${about.file} has changed on disk; the columns are as it says now.`); }
  } catch (error) { say(error.message); } finally { following = false; }
});
refresh();
