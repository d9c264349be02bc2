// A new calculation: rows of inputs and results, checked while one types; what is wrong stands beside its field.
import { call, made, say } from "./workbench.js";

const form = document.getElementById("new"), faults = document.getElementById("faults"), done = document.getElementById("done");
const COLUMNS = {
  inputs: [["name", "Name", "force"], ["symbol", "Symbol", "F"], ["default", "Default", "120"], ["unit", "Unit", "N"], ["lower", "At least", "> 0"], ["upper", "At most", ""], ["note", "Note", "normal load"]],
  results: [["name", "Name", "pressure"], ["symbol", "Symbol", "p"], ["formula", "Formula", "force / area"], ["unit", "Unit", "MPa"], ["value", "At the defaults", null], ["note", "Note", "contact pressure"]],
};
const touched = new Set();
let all = false, number = 0, typed = false;

function add(kind, focus) {
  const body = document.getElementById(kind).tBodies[0], row = made("tr"), ident = `${kind}-${number++}`;
  const what = kind === "inputs" ? "input" : "result";
  for (const [key, label, hint] of COLUMNS[kind]) {
    const cell = made("td", { className: `of-${key}` });
    cell.dataset.label = label;
    if (hint === null) { cell.append(made("output", { className: "value-shown" })); row.append(cell); continue; }
    const input = made("input", { id: `${ident}-${key}`, placeholder: body.rows.length ? "" : hint, spellcheck: key === "note", autocapitalize: "off" });
    const answer = made("p", { className: "answer bad", id: `${ident}-${key}-fault` });
    answer.setAttribute("aria-live", "polite");
    input.dataset.key = key;
    input.setAttribute("aria-label", `${label} of ${what} ${body.rows.length + 1}`);
    input.setAttribute("aria-describedby", answer.id);
    cell.append(input, answer);
    row.append(cell);
  }
  const remove = made("button", { type: "button", className: "plain", textContent: "×" });
  remove.setAttribute("aria-label", `Remove ${what} ${body.rows.length + 1}`);
  remove.onclick = () => { const next = row.nextElementSibling || row.previousElementSibling; row.remove(); check(); (next?.querySelector("input") || document.querySelector(`[data-add="${kind}"]`)).focus(); };
  row.append(made("td", { className: "of-remove" }, remove));
  body.append(row);
  if (focus) row.querySelector("input").focus();
}

const rowsOf = (kind) => [...document.getElementById(kind).tBodies[0].rows];
const valuesOf = (row) => Object.fromEntries([...row.querySelectorAll("input")].map((input) => [input.dataset.key, input.value]));
const kindNow = () => form.elements.kind.value;
const formNow = () => ({
  name: document.getElementById("name").value.trim(), title: document.getElementById("title").value,
  inputs: rowsOf("inputs").map(valuesOf), results: rowsOf("results").map(valuesOf),
});

// One question at a time; what was typed meanwhile is asked next.
let asking = false, again = false, timer;
function check() { clearTimeout(timer); timer = setTimeout(ask, 120); }
async function ask() {
  if (asking) { again = true; return; }
  asking = true;
  try { show(await call("/api/new/check", { form: formNow() })); } catch (error) { say(error.message); }
  asking = false;
  if (again) { again = false; ask(); }
}

function fieldOf(path) {
  const [kind, index, key] = path.split(".");
  if (key === undefined) return document.querySelector(`[data-path="${kind}"]`);
  return rowsOf(kind)[index]?.querySelector(`[data-key="${key}"]`);
}

function show({ faults: wrong, values = {} }) {
  for (const input of form.querySelectorAll("input[data-key], input[data-path]")) tellAt(input, "");
  for (const kind of ["inputs", "results"]) document.getElementById(`fault-${kind}`).textContent = all && wrong[kind] || "";
  for (const [path, sentence] of Object.entries(wrong)) {
    const field = fieldOf(path);
    if (field && (all || touched.has(field) && field.value !== "" || field.value !== "")) tellAt(field, sentence);
  }
  rowsOf("results").forEach((row, index) => { row.querySelector(".value-shown").textContent = values[`results.${index}`] || ""; });
}

function tellAt(input, sentence) {
  const answer = document.getElementById(input.dataset.path ? `fault-${input.dataset.path}` : `${input.id}-fault`);
  if (answer.textContent !== sentence) answer.textContent = sentence;
  answer.classList.toggle("bad", sentence !== "");
  if (sentence) input.setAttribute("aria-invalid", "true"); else input.removeAttribute("aria-invalid");
}

form.addEventListener("input", (event) => {
  if (event.target.name === "kind") return;
  typed = true;
  touched.add(event.target);
  check();
});
for (const button of form.querySelectorAll("[data-add]")) button.onclick = () => add(button.dataset.add, true);
for (const radio of form.elements.kind) radio.addEventListener("change", () => {
  for (const way of form.querySelectorAll(".way")) way.hidden = way.dataset.way !== kindNow();
});
addEventListener("beforeunload", (event) => { if (typed) event.preventDefault(); });

// The draft of a workbook: what became of its cells, and the file as it would be written.
const ofBook = () => ({ book: document.getElementById("book").value, place: document.getElementById("place").value });
document.getElementById("draft").onclick = async () => {
  const shown = document.getElementById("drafted");
  try {
    const { inputs, results, said, text } = await call("/api/new/draft", { form: formNow(), ...ofBook() });
    const file = made("pre", { textContent: text, tabIndex: 0 });
    file.setAttribute("aria-label", "The file as it would be written");
    shown.replaceChildren(made("p", { textContent: `${inputs} inputs, ${results} results` }), made("ul", {}, ...said.map((line) => made("li", { textContent: line }))), file);
  } catch (error) { shown.replaceChildren(made("p", { className: "answer bad", textContent: error.message })); }
};

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  all = true;
  faults.replaceChildren();
  try {
    const answer = await call("/api/new/make", { kind: kindNow(), form: formNow(), ...(kindNow() === "workbook" ? ofBook() : {}) });
    if (answer.faults && Object.keys(answer.faults).length) {
      show(answer);
      form.querySelector("[aria-invalid]")?.focus();
      return;
    }
    typed = false;
    finished(answer);
  } catch (error) { faults.replaceChildren(...(error.faults || [error]).map((fault) => made("li", { textContent: fault.message }))); }
});

function finished(answer) {
  form.hidden = true;
  done.hidden = false;
  if (answer.folder) {
    const command = `cd ${answer.folder}\npip install -e ".[test]"`;
    done.replaceChildren(made("h2", { textContent: `Made the project ${answer.folder}` }), made("p", { textContent: "It holds a placeholder, a clamped bar. Replace its physics by your own. Install it, and start calc serve again:" }), made("pre", { textContent: command }), made("ul", {}, ...answer.files.map((name) => made("li", { textContent: name }))));
    done.focus();
    return;
  }
  const open = made("button", { type: "button", className: "primary", textContent: `Begin ${answer.file.replace(/py$/, "toml")} and open it` });
  open.onclick = async () => {
    try {
      const { file } = await call("/api/begin", { plugin: answer.file, file: answer.file.replace(/py$/, "toml") });
      location.href = `/edit?file=${encodeURIComponent(file)}&plugin=${encodeURIComponent(answer.file)}`;
    } catch (error) { say(error.message); }
  };
  done.replaceChildren(made("h2", { textContent: `Made ${answer.file}` }), made("p", { textContent: "It has been calculated once at its defaults. It is an ordinary Python file: errors, limits and studies are added in an editor." }), made("ul", {}, ...(answer.said || []).map((line) => made("li", { textContent: line }))), open);
  open.focus();
}

add("inputs");
add("inputs");
add("results");
