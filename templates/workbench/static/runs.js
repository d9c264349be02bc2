// The list of runs and diagnoses: sorted by a column, filtered by words, two chosen to be compared.
import { Faults, call, listen, made, say, tell } from "./workbench.js";

const table = document.getElementById("runs");
if (table) list(table);

// The Word document is made in the background; once it is there, it is a file like the others.
const word = document.getElementById("word");
let making = "";
if (word) {
  word.onclick = async () => {
    try {
      making = (await call("/api/word", { folder: word.dataset.folder })).ident;
      word.disabled = true;
    } catch (error) { say(error.message); }
  };
  listen("", ({ jobs }) => {
    const job = jobs.find((each) => each.ident === making);
    if (!job || !["done", "failed", "cancelled"].includes(job.status)) return;
    making = "";
    if (job.status !== "done") { word.disabled = false; return; }
    const address = `/file/${[...word.dataset.folder.split("/"), "sheet.docx"].map(encodeURIComponent).join("/")}?download`;
    const link = made("a", { textContent: "Sheet, Word", href: address, download: "" });
    word.parentElement.replaceChildren(link);
    document.getElementById("keep").open = true;
    tell("The Word document is there: see Download.");
    link.focus();
  });
}

// What is made when it is asked for: said while it is made, and what goes wrong is said and not downloaded.
for (const link of document.querySelectorAll('a[href^="/api/made/"]')) link.onclick = async (event) => {
  event.preventDefault();
  tell(`${link.textContent}: the download begins as soon as it is made.`);
  try {
    const answer = await fetch(link.href);
    if (!answer.ok) throw new Faults((await answer.json()).faults);
    const name = decodeURIComponent(answer.headers.get("content-disposition").split("''")[1]);
    const address = URL.createObjectURL(await answer.blob());
    made("a", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60000);
    tell("");
  } catch (error) { tell(""); say(error.message); }
};

const copy = document.getElementById("copy");
if (copy) copy.onclick = async () => {
  try {
    const { folder } = await call("/api/keep", { folder: copy.dataset.folder });
    location.href = `/run?folder=${encodeURIComponent(folder)}`;
  } catch (error) { say(error.message); }
};

function list(table) {
  const body = table.tBodies[0], heads = [...table.tHead.rows[0].cells], rows = [...body.rows];
  const compareText = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" }).compare;

  function sort(place, direction) {
    const isNumber = heads[place].dataset.sort === "number", sign = direction === "ascending" ? 1 : -1;
    rows.sort((one, other) => {
      const [a, b] = [one, other].map((row) => row.cells[place].dataset.key);
      if (a === "" || b === "") return (a === "") - (b === "");
      return sign * (isNumber ? Number(a) - Number(b) : compareText(a, b));
    });
    body.append(...rows);
    for (const head of heads) head.removeAttribute("aria-sort");
    heads[place].setAttribute("aria-sort", direction);
  }
  heads.forEach((head, place) => {
    if (!head.dataset.sort) return;
    const first = head.dataset.first || "ascending", other = first === "ascending" ? "descending" : "ascending";
    const button = made("button", { type: "button", textContent: head.textContent });
    button.onclick = () => sort(place, head.getAttribute("aria-sort") === first ? other : first);
    head.replaceChildren(button);
  });

  const filter = document.getElementById("filter"), count = document.getElementById("count");
  function show() {
    const wanted = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of rows) {
      const words = row.textContent.toLowerCase();
      row.hidden = !wanted.every((word) => words.includes(word));
      shown += !row.hidden;
    }
    count.textContent = wanted.length ? `${shown} of ${rows.length}` : `${rows.length} in all`;
  }
  filter.addEventListener("input", show);

  choosing(rows);
  changes(rows).then(show).catch((error) => say(error.message));
}

// Of two that are chosen the older one is "before", whatever the order of the list.
function choosing(rows) {
  const compare = document.getElementById("compare"), chosen = [];
  for (const row of rows) {
    const box = row.querySelector(".choose");
    box.onchange = () => {
      if (box.checked) chosen.push(row); else chosen.splice(chosen.indexOf(row), 1);
      while (chosen.length > 2) mark(chosen.shift(), false);
      mark(row, box.checked);
      offer();
    };
  }
  function mark(row, is) { row.querySelector(".choose").checked = is; row.classList.toggle("chosen", is); }
  function offer() {
    const kinds = new Set(chosen.map((row) => row.dataset.kind));
    const can = chosen.length === 2 && kinds.size === 1;
    compare.setAttribute("aria-disabled", String(!can));
    say(chosen.length === 2 && !can ? "A run and a diagnosis cannot be compared; choose two of one kind." : "");
    if (!can) { compare.removeAttribute("href"); return; }
    const date = (row) => Number(row.cells[2].dataset.key);
    const [before, after] = [...chosen].sort((one, other) => date(one) - date(other)).map((row) => encodeURIComponent(row.dataset.name));
    compare.href = `/compare?before=${before}&after=${after}`;
  }
}

async function changes(rows) {
  const { changed, before } = await call("/api/changed", {});
  for (const row of rows) {
    const name = row.dataset.name, cell = row.querySelector(".changed");
    if (!(name in changed)) { cell.textContent = "the first"; continue; }
    cell.dataset.key = changed[name];
    const link = made("a", { textContent: changed[name], href: `/compare?before=${encodeURIComponent(before[name])}&after=${encodeURIComponent(name)}` });
    cell.replaceChildren(link);
  }
}
