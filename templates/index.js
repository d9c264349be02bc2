"use strict";
(() => {
  const table = document.getElementById("runs");
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  const rows = [...body.rows];
  const words = new Map(rows.map(row => [row, row.textContent.toLowerCase()]));
  const compareText = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" }).compare;

  const sort = (place, direction) => {
    const isNumber = heads[place].dataset.sort === "number";
    const sign = direction === "ascending" ? 1 : -1;
    const key = row => row.cells[place].dataset.key;
    const compare = (one, other) => {
      const [a, b] = [key(one), key(other)];
      if (a === "" || b === "") return (a === "") - (b === "");
      return sign * (isNumber ? Number(a) - Number(b) : compareText(a, b));
    };
    rows.sort(compare);
    body.append(...rows);
    for (const head of heads) head.removeAttribute("aria-sort");
    heads[place].setAttribute("aria-sort", direction);
  };

  heads.forEach((head, place) => {
    if (!head.dataset.sort) return;
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent;
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const first = head.dataset.first || "ascending";
      const other = first === "ascending" ? "descending" : "ascending";
      sort(place, head.getAttribute("aria-sort") === first ? other : first);
    });
  });

  const filter = document.createElement("div");
  filter.className = "filter";
  filter.setAttribute("role", "search");
  const label = document.createElement("label");
  label.textContent = "Show rows with ";
  const input = document.createElement("input");
  input.type = "search";
  input.placeholder = "words, such as: fails press_linkage";
  label.append(input);
  const said = document.createElement("p");
  said.setAttribute("role", "status");
  filter.append(label, said);
  table.closest(".scroll").before(filter);
  input.addEventListener("input", () => {
    const wanted = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const row of rows) {
      row.hidden = !wanted.every(word => words.get(row).includes(word));
      shown += !row.hidden;
    }
    said.textContent = wanted.length ? `${shown} of ${rows.length}` : "";
  });
})();
