// The form beside the text: every change is made by the server from the text; the page shows what came of it.
//   change(path, value)   state a value (a text, a number, true, a list of names; null takes it out)
//   textNow()             the text as it is being edited
//   save()                write the file; true where the page and the file say the same afterwards
//   says truing:state ({text, state}) after every answered change

import { call, listen, made, say, tell } from "./workbench.js";

const page = document.getElementById("edit"), text = document.getElementById("text"), form = document.getElementById("form");
const about = { file: page.dataset.file, plugin: page.dataset.plugin };
const STEP = 1500; // ms of rest after which typing in the text begins another step of undo
let saved = { text: text.value, digest: page.dataset.digest };
let state = null;

export const textNow = () => text.value;
export function change(path, value) { return ask({ path, value: typeof value === "number" ? String(value) : value }); }

// Steps: what undo goes back over. A visit of a field is one step: each change in it is made from the text before it.

const past = [], future = [];
let step = null, known = text.value;

function begin(key) {
  const now = performance.now(), visited = document.activeElement?.closest("[data-key]")?.dataset.key === key;
  const same = step?.key === key && step.after === text.value && (visited || now - step.at < STEP);
  if (!same) { push(known); step = { key, before: text.value }; }
  step.at = now;
  return step.before;
}

function push(value) { if (past.at(-1) !== value) past.push(value); future.length = 0; }

function go(from, to) {
  while (from.length && from.at(-1) === text.value) from.pop();
  if (!from.length) return;
  to.push(text.value);
  replace(from.pop());
}

// Show another text; whatever was being changed is dropped.
function replace(value) {
  waiting.clear();
  epoch += 1;
  step = null;
  put(value);
  mark();
  work();
}

// Put a text in its place; caret and view stay where they are in it.
function put(value) {
  const old = text.value, { selectionStart, selectionEnd, scrollTop, scrollLeft } = text;
  let same = 0;
  while (same < old.length && same < value.length && old[same] === value[same]) same += 1;
  const moved = (caret) => Math.max(0, caret <= same ? caret : caret + value.length - old.length);
  text.value = known = value;
  if (document.activeElement === text) text.setSelectionRange(moved(selectionStart), moved(selectionEnd));
  Object.assign(text, { scrollTop, scrollLeft });
}

// Requests: one at a time; of what comes meanwhile the latest of each field is sent next.

const waiting = new Map();
let working = null, epoch = 0, isStale = false;

function ask(wanted) {
  waiting.set(wanted.path.join("/"), wanted);
  mark();
  return work();
}

function work() {
  isStale = true;
  working ??= (async () => {
    try { while (waiting.size || isStale) await once(); } finally { working = null; mark(); }
  })();
  return working;
}

async function once() {
  const [key, wanted] = waiting.entries().next().value ?? [null, null];
  if (wanted && !("value" in wanted)) step = null; // of what has been typed, not of the text before it
  waiting.delete(key);
  isStale = false;
  const sent = text.value, when = epoch, from = wanted ? begin(key) : sent;
  try {
    const answer = await call("/api/state", { ...about, text: from, saved: saved.text ?? "", change: wanted });
    if (when !== epoch) { isStale = true; return; }
    if (text.value !== sent) { // typed in the text meanwhile: the change is made in that
      if (wanted && !waiting.has(key)) waiting.set(key, wanted);
      isStale = true;
      return;
    }
    if (answer.text !== sent) put(answer.text);
    if (step && wanted) step.after = answer.text;
    show(answer);
    if (wanted && "unit" in wanted) showField(fields.get(key), true);
  } catch (error) {
    const field = fields.get(key);
    if (field) answered(field, [error.message], ""); else say(error.message);
  }
}

// Fields

const fields = new Map(), parts = [];

for (const element of form.querySelectorAll("[data-key]")) {
  const { key, kind, unit } = element.dataset, path = JSON.parse(element.dataset.path);
  const control = element.querySelector(kind ? "input, select" : ".switch");
  fields.set(key, {
    key, kind: kind ?? "effect", path, element, control, declared: unit,
    reset: kind ? element.querySelector(".reset") : null, units: element.querySelector(kind ? "select.unit" : ":scope > none"),
    answer: document.getElementById(`answer.${key}`),
  });
}
for (const element of form.querySelectorAll("details")) {
  const inside = [...element.querySelectorAll("[data-key]")].map((each) => fields.get(each.dataset.key));
  parts.push({ element, inside, stated: element.querySelector(".stated"), faulty: element.querySelector(".faulty") });
}

function show(answer) {
  state = answer;
  for (const field of fields.values()) showField(field);
  for (const { inside, stated, faulty } of parts) {
    const values = inside.filter((field) => field.kind !== "effect" && stated_of(field)?.value !== undefined).length;
    const effects = inside.filter((field) => field.kind === "effect"), on = effects.filter((field) => stated_of(field)).length;
    const faults = inside.reduce((sum, field) => sum + (stated_of(field)?.faults?.length ?? 0), 0);
    write(stated, effects.length ? `${on} of ${effects.length} on` : values ? `${values} of ${inside.length} stated` : "as declared");
    write(faulty, faults ? `${faults} ${faults === 1 ? "fault" : "faults"}` : "");
  }
  showFaults(answer.faults);
  showOthers(answer.others);
  mark();
  document.dispatchEvent(new CustomEvent("truing:state", { detail: { text: answer.text, state: answer } }));
}

function stated_of(field) { return state?.fields[field.key]; }

function write(element, words) { if (element.textContent !== words) element.textContent = words; }

function showField(field, isMadeHere = false) {
  const stated = stated_of(field), value = stated?.value, isStated = value !== undefined;
  answered(field, stated?.faults ?? [], stated?.answer ?? "");
  field.element.classList.toggle("is-stated", isStated);
  if (field.reset) field.reset.hidden = !isStated;
  if (field.kind === "effect") {
    field.control.checked = isStated;
    field.element.querySelector(".inside").hidden = !isStated;
  } else if (field.kind === "list") {
    for (const box of field.element.querySelectorAll("input")) box.checked = isStated ? value.includes?.(box.value) : true;
  } else if (field.kind === "switch") {
    field.control.checked = isStated ? value === true : "default" in field.control.dataset;
  } else if (isMadeHere || (document.activeElement !== field.control && !waiting.has(field.key))) {
    if (isStated && field.control.tagName === "SELECT" && ![...field.control.options].some((option) => option.value === String(value))) {
      field.control.append(made("option", { value: String(value), textContent: String(value) }));
    }
    field.control.value = isStated ? String(value) : "";
  }
  if (field.units) showUnit(field, isStated ? String(value) : "");
}

function showUnit({ units, declared }, value) {
  const own = value ? value.replace(/^\s*[+-]?[\d.]*(?:e[+-]?\d+)?\s*/i, "").trim() : declared;
  const option = [...units.options].find((each) => each.value && (each.value === own || each.textContent === own));
  if (document.activeElement !== units || option) units.value = option ? option.value : "";
}

let speaks;
function answered(field, faults, answer) {
  const words = faults.length ? faults.join("\n") : answer;
  field.answer.classList.toggle("bad", faults.length > 0);
  field.element.classList.toggle("wrong", faults.length > 0);
  if (faults.length) field.control.setAttribute("aria-invalid", "true"); else field.control.removeAttribute("aria-invalid");
  if (field.answer.textContent === words) return;
  field.answer.textContent = words;
  if (!field.element.contains(document.activeElement)) return;
  clearTimeout(speaks); // for screen readers: what it is once typing rests
  speaks = setTimeout(() => write(document.getElementById("field-said"), words), 700);
}

function fieldOf(event) { return fields.get(event.target.closest("[data-key]")?.dataset.key); }

form.addEventListener("input", (event) => {
  const field = fieldOf(event), { target } = event;
  if (!field || target.classList.contains("unit")) return;
  if (field.kind === "effect") ask({ path: field.path, on: target.checked });
  else if (field.kind === "list") change(field.path, ticked(field));
  else if (field.kind === "switch") change(field.path, target.checked);
  else change(field.path, target.value.trim() === "" ? null : target.value);
});
form.addEventListener("change", (event) => {
  const field = fieldOf(event);
  if (field && event.target === field.units && event.target.value) ask({ path: field.path, unit: event.target.value });
});
form.addEventListener("click", (event) => {
  const field = fieldOf(event);
  if (!field || event.target !== field.reset) return;
  step = null;
  field.control.focus();
  if ("value" in field.control && field.kind !== "list" && field.kind !== "switch") field.control.value = "";
  change(field.path, null);
});
form.addEventListener("focusout", (event) => {
  const field = fieldOf(event);
  if (field && step?.key === field.key && !field.element.contains(event.relatedTarget)) step = null;
  if (field && state && !waiting.has(field.key) && !working) setTimeout(() => showField(field));
});
form.addEventListener("submit", (event) => event.preventDefault());

// The names that are ticked: those of the text in its order, a new one where it stands among all.
function ticked(field) {
  const boxes = [...field.element.querySelectorAll("input")], all = boxes.map((box) => box.value);
  const on = new Set(boxes.filter((box) => box.checked).map((box) => box.value));
  const value = stated_of(field)?.value, kept = (Array.isArray(value) ? value : all).filter((name) => on.delete(name));
  for (const name of on) {
    const after = kept.findIndex((other) => all.indexOf(other) > all.indexOf(name));
    kept.splice(after < 0 ? kept.length : after, 0, name);
  }
  return kept;
}

// Faults, and what has no field

let shownFaults = "", shownOthers = "";

function showFaults(faults) {
  if (JSON.stringify(faults) === shownFaults) return;
  shownFaults = JSON.stringify(faults);
  document.getElementById("faults").replaceChildren(...faults.map((fault) => {
    const go = () => { if (fault.key && fields.has(fault.key)) toField(fields.get(fault.key)); else if (fault.line) toLine(fault.line); };
    const line = made("li", {}, made("button", { type: "button", className: "plain", textContent: fault.message, onclick: go }));
    if (fault.line) line.append(" ", lineButton(fault.line));
    return line;
  }));
}

function showOthers(others) {
  if (JSON.stringify(others) === shownOthers) return;
  shownOthers = JSON.stringify(others);
  const lines = others.map(({ name, line }) => made("li", {}, made("code", { textContent: name }), " ", lineButton(line)));
  if (lines.length) lines.unshift(made("li", { className: "quiet", textContent: "Stated in the text, without a field here:" }));
  document.getElementById("others").replaceChildren(...lines);
}

function lineButton(line) {
  return made("button", { type: "button", className: "plain line", textContent: `line ${line}`, onclick: () => toLine(line) });
}

function bring(element) {
  const panel = element.closest(".columns > *");
  if (panel && !panel.offsetParent) document.getElementById(`${panel.id}-tab`)?.click();
}

function toField(field) {
  if (field.element.matches(".is-out")) { search.value = ""; filter(); }
  bring(field.element);
  for (let at = field.element; at && at !== form; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  field.control.focus();
  field.element.scrollIntoView({ block: "center" });
}

function toLine(line) {
  bring(text);
  const lines = text.value.split("\n"), start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  text.focus();
  text.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
  text.scrollTop = Math.max(0, (line - 6) * (text.scrollHeight / lines.length));
}

// Search

const search = document.getElementById("search"), before = new Map();
search.addEventListener("input", filter);

function filter() {
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length && !before.size) for (const { element } of parts) before.set(element, element.open);
  const isIn = (element, also) => words.every((word) => element.dataset.search.includes(word) || also.includes(word));
  let hits = 0;
  for (const field of fields.values()) {
    if (field.kind === "effect") continue;
    const part = field.element.closest(".part"), is = isIn(field.element, part?.dataset.search ?? "");
    field.element.classList.toggle("is-out", !is);
    hits += is;
  }
  for (const part of form.querySelectorAll("fieldset.part")) {
    const is = !words.length || isIn(part, "") || part.querySelector(".field:not(.is-out)");
    part.classList.toggle("is-out", !is);
  }
  for (const { element } of parts) {
    const is = !words.length || element.querySelector(".field:not(.is-out), fieldset.part:not(.is-out)");
    element.classList.toggle("is-out", !is);
    if (words.length) element.open = Boolean(is); else if (before.has(element)) element.open = before.get(element);
  }
  if (!words.length) before.clear();
  write(document.getElementById("hits"), words.length ? `${hits} ${hits === 1 ? "field" : "fields"}` : "");
}

// The text

text.addEventListener("input", () => {
  const now = performance.now();
  if (step?.key !== "text" || now - step.at > STEP) push(known);
  step = { key: "text", at: now };
  known = text.value;
  mark();
  work();
});

// Undo, redo, save

const buttons = Object.fromEntries(["save", "undo", "redo", "keep", "take"].map((name) => [name, document.getElementById(name)]));
buttons.undo.onclick = () => go(past, future);
buttons.redo.onclick = () => go(future, past);
buttons.save.onclick = save;

function isUnsaved() { return text.value !== saved.text || waiting.size > 0; }

function mark() {
  buttons.save.disabled = !isUnsaved();
  buttons.undo.disabled = past.every((value) => value === text.value);
  buttons.redo.disabled = future.every((value) => value === text.value);
  write(document.getElementById("saved"), isUnsaved() ? "not saved" : "saved");
}

document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  const key = event.key.toLowerCase(), types = event.target.matches?.('textarea, input:not([type="checkbox"], [type="range"])');
  if (key === "s") save();
  else if (!types && (key === "y" || (key === "z" && event.shiftKey))) go(future, past);
  else if (!types && key === "z") go(past, future);
  else return;
  event.preventDefault();
});
addEventListener("beforeunload", (event) => { if (isUnsaved()) event.preventDefault(); });

let saving = null;

export function save() {
  saving ??= written().finally(() => { saving = null; });
  return saving;
}

async function written() {
  while (working) await working;
  const sent = text.value;
  if (sent === saved.text) return true;
  try {
    const answer = await call("/api/save", { file: about.file, text: sent, base: saved.digest });
    if (answer.conflict) { await changed(); return false; }
    saved = { text: sent, digest: answer.digest };
    hide();
  } catch (error) { say(error.message); return false; }
  mark();
  return !isUnsaved();
}

// The file as others change it

let there = null, looking = null;
listen(about.file, async ({ digest }) => {
  if (saving) await saving;
  if (digest !== saved.digest && !(digest === "" && saved.text === null)) changed();
});

function changed() {
  looking ??= look().catch((error) => say(error.message)).finally(() => { looking = null; });
  return looking;
}

async function look() {
  while (working) await working;
  const seen = await call("/api/read", { file: about.file, text: text.value });
  if (seen.digest === saved.digest && !seen.gone) return;
  if (seen.gone) {
    saved = { text: null, digest: seen.digest };
    say(`${about.file} is gone from the folder; Save writes it again.`);
  } else if (seen.text === text.value) {
    saved = seen;
    hide();
  } else if (isUnsaved() && saved.text !== seen.text) {
    showConflict(seen);
  } else {
    const was = saved.text;
    saved = seen;
    if (text.value === was) {
      push(text.value);
      replace(seen.text);
      tell(`${about.file} has changed on disk; this is what it says now. Undo brings the text from before.`);
    }
  }
  mark();
}

const panel = document.getElementById("conflict");

function showConflict(seen) {
  there = seen;
  panel.querySelector("tbody").replaceChildren(...seen.differences.map(({ mine, theirs, mine_line, theirs_line }) => {
    const cell = (lines, label) => { const made_cell = made("td", {}, made("pre", { textContent: lines.join("\n") || "–" })); made_cell.dataset.label = label; return made_cell; };
    const line = mine.length ? mine_line : theirs_line;
    return made("tr", {}, made("td", { textContent: line }), cell(mine, "Here"), cell(theirs, "In the file"));
  }));
  panel.hidden = false;
  write(document.getElementById("conflict-title"), `${about.file} has changed on disk, and what you changed here is not saved`);
}

function hide() { panel.hidden = true; there = null; }

buttons.keep.onclick = () => {
  push(there.text);
  saved = { text: there.text, digest: there.digest };
  hide();
  mark();
  buttons.save.focus();
};
buttons.take.onclick = () => {
  push(text.value);
  saved = { text: there.text, digest: there.digest };
  replace(there.text);
  hide();
  mark();
  text.focus();
};

work();
