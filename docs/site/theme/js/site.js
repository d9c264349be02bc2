// Search, light and dark, the menu of narrow screens, and a button that copies commands. Nothing here is needed to read.
"use strict";
const base = document.currentScript.dataset.base;
const root = document.documentElement;

document.querySelector(".theme").addEventListener("click", () => {
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
  try { localStorage.setItem("theme", root.dataset.theme); } catch { /* a page from disk may not remember */ }
});

const menu = document.querySelector(".menu");
menu.addEventListener("click", () => {
  const open = document.getElementById("sidebar").classList.toggle("open");
  menu.setAttribute("aria-expanded", String(open));
});
document.querySelector("#sidebar [aria-current]")?.scrollIntoView({ block: "center" });
scrollTo({ top: location.hash ? scrollY : 0 });
const contents = document.querySelector(".toc");
const beside = document.querySelector("main.wide") ? "(min-width: 92rem)" : "(min-width: 80rem)";
if (contents && matchMedia(beside).matches) contents.open = true;

// What is folded opens where a link leads into it, when the page is printed, and all at once by a button.
const folded = [...document.querySelectorAll("article details")];
function unfoldTarget() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  for (let part = target?.closest("details"); part; part = part.parentElement.closest("details")) part.open = true;
  let next = target?.matches("h3") && target.nextElementSibling;
  if (next && next.matches("p")) next = next.nextElementSibling;
  if (next && next.matches("details")) next.open = true;
  target?.scrollIntoView();
}
addEventListener("hashchange", unfoldTarget);
if (location.hash) unfoldTarget();
addEventListener("beforeprint", () => { for (const part of folded) { part.dataset.was = part.open; part.open = true; } });
addEventListener("afterprint", () => { for (const part of folded) part.open = part.dataset.was === "true"; });
const list = document.querySelector("article .contents")?.closest(".scroll");
if (folded.length > 3 && list) {
  const button = Object.assign(document.createElement("button"), { type: "button", className: "unfold", textContent: "Unfold all" });
  button.addEventListener("click", () => {
    const open = folded.some((part) => !part.open);
    for (const part of folded) part.open = open;
    button.textContent = open ? "Fold all" : "Unfold all";
  });
  list.after(button);
}

for (const block of document.querySelectorAll(".highlight")) {
  const button = Object.assign(document.createElement("button"), { type: "button", className: "copy", textContent: "Copy" });
  button.addEventListener("click", async () => {
    const lines = [...block.querySelectorAll("pre code")].map((code) => code.textContent).join("");
    const commands = lines.split("\n").filter((line) => line.startsWith("$ ")).map((line) => line.slice(2));
    await navigator.clipboard.writeText(commands.length ? commands.join("\n") : lines);
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  });
  block.append(button);
}

const field = document.getElementById("search");
const found = document.querySelector(".found");
// Without accents and capitals, letter for letter, so that a place in it is a place in the text.
const plain = (text) => text.replace(/[^\x00-\x7f]/gu, (letter) => {
  const bare = letter.normalize("NFKD").replace(/\p{M}/gu, "");
  return bare.length === letter.length ? bare : letter;
}).toLowerCase();
let pages = null;

function load() {
  if (pages) return Promise.resolve(pages);
  return new Promise((done, failed) => {
    const script = Object.assign(document.createElement("script"), { src: `${base}/search/index.js`, onerror: failed });
    script.onload = () => {
      const titles = new Map(window.pagesOfTheManual.filter(([place]) => !place.includes("#")).map(([place, title]) => [place, title]));
      pages = window.pagesOfTheManual.map(([place, title, text]) => ({
        place, title, text, page: titles.get(place.split("#")[0]) ?? "", inTitle: plain(title), inText: plain(text),
      }));
      done(pages);
    };
    document.head.append(script);
  });
}

// All words must occur; a word in the heading counts most, at the beginning of a word more than within one, often more than once.
function worth(item, words) {
  let sum = 0;
  for (const word of words) {
    const title = item.inTitle.indexOf(word), text = item.inText.indexOf(word);
    if (title < 0 && text < 0) return 0;
    const begins = new RegExp(`(^|[^\\p{L}\\p{N}])${word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}`, "u");
    if (title >= 0) sum += 20 + (begins.test(item.inTitle) ? 20 : 0) + (item.inTitle === word ? 40 : 0);
    if (text >= 0) sum += Math.min(item.inText.split(word).length - 1, 8) + (begins.test(item.inText) ? 4 : 0);
  }
  return sum + (item.place.includes("#") ? 0 : 3);
}

function excerpt(item, words) {
  const first = Math.min(...words.map((word) => item.inText.indexOf(word)).filter((place) => place >= 0), item.text.length);
  const from = Math.max(0, first - 50);
  const piece = document.createElement("p");
  const shown = item.text.slice(from, from + 170).replace(/\s+/g, " ");
  const parts = words.map((word) => word.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("|");
  piece.append(from ? "… " : "");
  for (const part of shown.split(new RegExp(`(${parts})`, "iu"))) {
    const hit = words.includes(plain(part));
    piece.append(hit ? Object.assign(document.createElement("mark"), { textContent: part }) : part);
  }
  return piece;
}

async function search() {
  const words = plain(field.value).split(/\s+/).filter((word) => word);
  found.hidden = !words.length;
  if (!words.length) return;
  const all = (await load()).map((item) => [worth(item, words), item]).filter(([value]) => value);
  const best = all.sort(([one], [other]) => other - one).slice(0, 20);
  found.replaceChildren(...best.map(([, item]) => {
    const link = Object.assign(document.createElement("a"), { href: `${base}/${item.place}` });
    link.append(item.title);
    if (item.page && item.page !== item.title) link.append(Object.assign(document.createElement("span"), { className: "where", textContent: ` · ${item.page}` }));
    link.append(excerpt(item, words));
    return link;
  }));
  if (!best.length) found.append(Object.assign(document.createElement("div"), { className: "none", textContent: "Nothing found." }));
}

field.addEventListener("focus", () => { load(); });
field.addEventListener("input", search);
field.form.addEventListener("submit", (event) => { event.preventDefault(); found.querySelector("a")?.click(); });
document.addEventListener("click", (event) => { if (!event.target.closest(".search")) found.hidden = true; });
document.addEventListener("keydown", (event) => {
  const inside = event.target.closest("input, textarea");
  if (event.key === "/" && !inside) { event.preventDefault(); field.focus(); }
  if (event.key === "Escape") { found.hidden = true; field.blur(); }
  if ((event.key === "ArrowDown" || event.key === "ArrowUp") && event.target.closest(".search")) {
    const all = [...found.querySelectorAll("a")];
    const place = all.indexOf(document.activeElement) + (event.key === "ArrowDown" ? 1 : -1);
    event.preventDefault();
    (place < 0 ? field : all[Math.min(place, all.length - 1)])?.focus();
  }
});
