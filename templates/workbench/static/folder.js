// The first page: what the calculations are for follows behind their names; programs open once they are confirmed.
import { call, made, say } from "./workbench.js";

const edit = (file, plugin) => `/edit?file=${encodeURIComponent(file)}${plugin.endsWith(".py") ? `&plugin=${encodeURIComponent(plugin)}` : ""}`;
const counted = (count, one, many) => `${count} ${count === 1 ? one : many}`;

// A card: title, what for, how large, figure, example, and the form that begins an inputs file.
function fill(card, model, plugin) {
  const facts = [counted(model.inputs, "input", "inputs"), counted(model.results, "result", "results"),
    model.effects && `${counted(model.effects, "cause", "causes")} that a diagnosis can name`, model.studies.length && `studies: ${model.studies.join(", ")}`];
  const heading = made("h3", { textContent: model.title });
  const name = made("span", { className: "quiet", textContent: ` ${plugin}${model.version ? ` ${model.version}` : ""}` });
  const figure = made("figure", { className: "drawing" });
  const text = made("pre", { tabIndex: 0 });
  text.setAttribute("aria-label", `Example of ${model.title}`);
  const example = made("details", {}, made("summary", { textContent: "Show the example" }), text);
  example.addEventListener("toggle", async () => {
    if (!example.open || text.textContent) return;
    try { text.textContent = (await call("/api/example", { plugin })).text; } catch (error) { say(error.message); }
  });
  heading.append(name);
  card.dataset.plugin = plugin;
  card.replaceChildren(heading, made("p", { textContent: model.summary }), made("p", { className: "facts", textContent: facts.filter(Boolean).join(" · ") }), figure, example, beginning(model, plugin));
  waiting.push({ figure, plugin, title: model.title });
  draw();
}

function beginning(model, plugin) {
  const file = made("input", { name: "file", value: `${model.name.replace(/.*\./, "")}.toml`, autocomplete: "off", spellcheck: false });
  const answer = made("p", { className: "answer bad", role: "alert" });
  const form = made("form", { className: "begin" }, made("label", { textContent: "New inputs file " }, file), made("button", { textContent: "Begin from the example" }), answer);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    answer.textContent = "";
    file.removeAttribute("aria-invalid");
    try {
      const begun = await call("/api/begin", { plugin, file: file.value });
      location.href = edit(begun.file, plugin);
    } catch (error) { answer.textContent = error.message; file.setAttribute("aria-invalid", "true"); file.focus(); }
  });
  return form;
}

// Figures are drawn one after another, so that a worker is left for what one does meanwhile.
const waiting = [];
let drawing = false;
async function draw() {
  if (drawing) return;
  drawing = true;
  while (waiting.length) {
    const { figure, plugin, title } = waiting.shift();
    try {
      const { title: what, svg } = await call("/api/picture", { plugin });
      if (svg) figure.replaceChildren(made("img", { alt: `${title}: ${what}`, src: `data:image/svg+xml,${encodeURIComponent(svg)}` }));
      else figure.remove();
    } catch { figure.remove(); }
  }
  drawing = false;
}

async function open(card) {
  const file = card.dataset.program;
  try { fill(card, await call("/api/program", { file }), file); card.dataset.confirmed = ""; return true; } catch (error) { say(error.message); return false; }
}
for (const card of document.querySelectorAll(".model[data-program]")) {
  card.querySelector(".open").onclick = async () => { if (await open(card)) { card.tabIndex = -1; card.focus(); } };
  if ("confirmed" in card.dataset) open(card);
}

// An inputs file of a program: the question comes before the page of the file.
for (const row of document.querySelectorAll("tr[data-program]")) {
  row.querySelector("a")?.addEventListener("click", async (event) => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    const address = event.currentTarget.href;
    try { await call("/api/program", { file: row.dataset.program }); location.href = address; } catch (error) { say(error.message); }
  });
}

async function installed() {
  const list = document.getElementById("installed");
  if (!list) return;
  try {
    const { models, broken } = await call("/api/models", {});
    list.replaceChildren(...models.map((model) => { const card = made("li", { className: "model" }); fill(card, model, model.name); return card; }));
    document.getElementById("broken").replaceChildren(...broken.map((text) => made("li", { textContent: text })));
  } catch (error) { say(error.message); }
  list.removeAttribute("aria-busy");
}

const rows = [...document.querySelectorAll("#inputs tbody tr")];

async function last() {
  if (!rows.length) return;
  try {
    const { last } = await call("/api/newest", {});
    for (const row of rows) {
      const run = last[row.dataset.file], cell = row.querySelector(".last");
      if (!run) { cell.textContent = "not run yet"; continue; }
      const [head, ...rest] = run.verdict.split(": ");
      cell.replaceChildren(made("a", { className: `badge ${run.state || "none"}`, textContent: head, href: `/run?folder=${encodeURIComponent(run.name)}` }), ` ${rest.join(": ")}`);
      row.querySelector(".date").textContent = run.date;
    }
  } catch (error) { say(error.message); }
}

async function faults() {
  if (!rows.length) return;
  try {
    const { faults } = await call("/api/faults", {});
    for (const row of rows) if (faults[row.dataset.file]) row.querySelector(".fault").textContent = faults[row.dataset.file];
  } catch (error) { say(error.message); }
}
last();
installed();
faults();
