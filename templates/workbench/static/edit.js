import { call, listen, say } from "./workbench.js";

const page = document.getElementById("edit");
const about = { file: page.dataset.file, plugin: page.dataset.plugin };
const text = document.getElementById("text");
let saved = { text: text.value, digest: page.dataset.digest };
const undone = [];
let busy = false, next = null;

async function refresh(change) {
  if (busy) { next = { change }; return; }
  busy = true;
  try {
    const state = await call("/api/state", { ...about, text: text.value, change });
    if (state.text !== text.value) { undone.push(text.value); text.value = state.text; }
    show(state);
    document.dispatchEvent(new CustomEvent("truing:state", { detail: { text: text.value, state } }));
  } catch (error) { say(error.message); }
  busy = false;
  mark();
  if (next) { const { change: waiting } = next; next = null; await refresh(waiting); }
}

function show(state) {
  for (const field of document.querySelectorAll(".field")) {
    const input = field.querySelector("input"), value = state.stated[JSON.parse(field.dataset.path).join(".")];
    if (document.activeElement !== input) input.value = value ?? "";
  }
}

function mark() {
  document.getElementById("save").disabled = text.value === saved.text;
  document.getElementById("undo").disabled = !undone.length;
}

document.getElementById("form").addEventListener("input", (event) => {
  const path = JSON.parse(event.target.closest(".field").dataset.path);
  refresh({ path, value: event.target.value === "" ? null : event.target.value });
});
text.addEventListener("input", () => refresh());
document.getElementById("undo").onclick = () => { text.value = undone.pop(); refresh(); };
document.getElementById("save").onclick = save;
export async function save() {
  const answer = await call("/api/save", { file: about.file, text: text.value, base: saved.digest });
  if ("conflict" in answer) { say("The file has changed on disk; nothing was written."); return false; }
  saved = { text: text.value, digest: answer.digest };
  mark();
  return true;
}
export function change(path, value) { return refresh({ path, value }); }
export function textNow() { return text.value; }
listen(about.file, () => {});
refresh();
