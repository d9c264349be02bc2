// What every page uses: calls, questions, sentences, the stream of changes, the line of jobs, columns as tabs.
//   call(address, body)      the answer of the server; throws Faults with its sentences
//   ask(question, yes, no)   a question in a dialog; true or false
//   say(text), tell(text)    a fault, until it is closed; news, for some seconds
//   listen(file, heard)      heard({jobs, digest}) at every change of the jobs and of the file; one stream a page

const STOPPED = "The server has stopped. Start calc serve again and open the address that it prints.";

export class Faults extends Error {
  constructor(faults) { super(faults.map((fault) => fault.message).join("\n")); this.faults = faults; }
}

export async function call(address, body, { signal } = {}) {
  let answer, said;
  try {
    answer = await fetch(address, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body), signal });
    said = answer.headers.get("content-type")?.startsWith("application/json") ? await answer.json() : null;
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Faults([{ message: STOPPED }]);
  }
  if (!said) throw new Faults([{ message: answer.status === 401 ? STOPPED : `The server answered with ${answer.status} ${answer.statusText}.` }]);
  if (answer.status === 409 && said.confirm) {
    if (!await ask(`${said.confirm} is a program. Run it?\nSay yes only if you know where it comes from.`, "Run it")) throw new Faults(said.faults);
    await call("/api/confirm", { file: said.confirm });
    return call(address, body, { signal });
  }
  if (said.overtaken || (!answer.ok && answer.status !== 409)) throw Object.assign(new Faults(said.faults), { overtaken: said.overtaken });
  return said;
}

// Make an element with properties and children: made("p", { className: "bad" }, "wrong").
export function made(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

export function ask(question, yes = "Yes", no = "Cancel") {
  const dialog = made("dialog", {}, made("p", { id: "asked", textContent: question }));
  const choices = made("div", { className: "choices" });
  for (const [text, value] of [[no, ""], [yes, "yes"]]) {
    choices.append(made("button", { type: "button", textContent: text, className: value && "primary", onclick: () => dialog.close(value) }));
  }
  dialog.append(choices);
  dialog.setAttribute("aria-labelledby", "asked");
  document.body.append(dialog);
  return new Promise((answered) => {
    dialog.addEventListener("close", () => { dialog.remove(); answered(dialog.returnValue === "yes"); }, { once: true });
    dialog.showModal();
  });
}

export function say(text) { shownAt("said", text); }

let fades;
export function tell(text) {
  shownAt("told", text);
  clearTimeout(fades);
  fades = setTimeout(() => shownAt("told", ""), 8000);
}

function shownAt(ident, text) {
  const close = made("button", { type: "button", className: "plain", textContent: "Close", onclick: () => shownAt(ident, "") });
  document.getElementById(ident).replaceChildren(...(text ? [made("p", { textContent: text }), close] : []));
}

// What nobody catches is said all the same.
addEventListener("unhandledrejection", (event) => {
  if (event.reason instanceof Faults) { event.preventDefault(); say(event.reason.message); }
});

document.addEventListener("keydown", (event) => {
  if (event.key === "Escape" && !document.querySelector("dialog[open]")) { say(""); shownAt("told", ""); }
});

// The stream: one for a page, closed while the page is hidden (a browser grants six connections to all tabs together).

let source = null, about = "", lost;
const hearing = [];

export function listen(file, heard) {
  hearing.push(heard);
  if (file && file !== about) { about = file; if (source) open(); }
}

function open() {
  source?.close();
  source = new EventSource(`/events?file=${encodeURIComponent(about)}`);
  source.onopen = () => gone(false);
  source.onmessage = (event) => {
    const seen = JSON.parse(event.data);
    showJobs(seen.jobs);
    for (const heard of hearing) heard(seen);
  };
  source.onerror = () => {
    lost ??= setTimeout(() => gone(true), 1500);
    if (source.readyState === EventSource.CLOSED) setTimeout(() => { if (source?.readyState === EventSource.CLOSED) open(); }, 2000);
  };
}

function gone(is) {
  clearTimeout(lost);
  lost = undefined;
  const banner = document.getElementById("gone"), text = is ? `${STOPPED} What you typed is still here.` : "";
  if (banner.textContent !== text) banner.textContent = text;
}

function pause() { clearTimeout(lost); lost = undefined; source?.close(); source = null; }
document.addEventListener("visibilitychange", () => { if (document.hidden) pause(); else if (!source) open(); });
addEventListener("pagehide", pause);
addEventListener("pageshow", (event) => { if (event.persisted && !source) open(); });
document.addEventListener("DOMContentLoaded", () => { if (!document.hidden) open(); });

// The jobs: what waits and runs, and how those ended that this page has seen running.

const lines = new Map();
const ENDED = { done: "done", failed: "failed", cancelled: "cancelled" };

function showJobs(jobs) {
  const known = new Set(jobs.map((job) => job.ident));
  for (const [ident, line] of lines) if (!known.has(ident)) { line.element.remove(); lines.delete(ident); }
  for (const job of jobs) {
    const ends = job.status in ENDED;
    if (!lines.has(job.ident) && !ends) lines.set(job.ident, lineOf(job));
    const line = lines.get(job.ident);
    if (line && line.status !== job.status && ends) ended(job, line);
    else if (line && !ends) going(job, line);
    if (line) line.status = job.status;
  }
}

function lineOf(job) {
  const stage = made("span", { className: "stage" }), bar = made("progress", { max: 1 });
  bar.setAttribute("aria-label", job.title);
  const stop = made("button", { type: "button", textContent: "Cancel" });
  stop.setAttribute("aria-label", `Cancel: ${job.title}`);
  stop.onclick = () => call("/api/cancel", { job: job.ident }).catch((error) => say(error.message));
  const element = made("div", { className: "job" }, made("span", { className: "title", textContent: job.title }), bar, stage, stop);
  document.getElementById("jobs").append(element);
  return { element, stage, bar, stop, status: "" };
}

function going(job, { stage, bar }) {
  const share = job.total ? job.done / job.total : null;
  const text = job.status === "waits" ? "waits for its turn" : [job.stage, share === null ? "" : `${Math.round(100 * share)} %`].filter(Boolean).join(" · ");
  if (stage.textContent !== text) stage.textContent = text;
  if (share === null || job.status === "waits") bar.removeAttribute("value"); else bar.value = share;
}

// Say once how a job ended, for screen readers as well; its line stays until it is closed.
function ended(job, line) {
  const { element, stage, bar, stop } = line;
  const text = [ENDED[job.status], ...job.faults.map((fault) => fault.message)].join(": ");
  bar.remove();
  stage.textContent = text;
  stage.classList.toggle("bad", job.status === "failed");
  if (job.answer?.folder) {
    const link = made("a", { href: `/run?folder=${encodeURIComponent(job.answer.folder)}`, textContent: "Open it" });
    link.setAttribute("aria-label", `Open it: ${job.title}`);
    stage.after(link);
  }
  stop.textContent = "Close";
  stop.setAttribute("aria-label", `Close: ${job.title}`);
  stop.onclick = () => { element.remove(); lines.set(job.ident, { ...line, element }); };
  document.getElementById("heard").textContent = `${job.title}: ${text}`;
}

// Columns: side by side, and on a phone tabs of which one is shown.

const PHONE = matchMedia("(max-width: 47.99rem)");

function nameOf(panel) {
  return panel.dataset.tab || panel.getAttribute("aria-label") || panel.querySelector("h2, label")?.textContent || "Part";
}

function tabbed(columns, number) {
  const panels = [...columns.children], list = made("div", { className: "tabs" });
  if (panels.length < 2) return;
  list.setAttribute("role", "tablist");
  list.setAttribute("aria-label", "Parts of the page");
  const tabs = panels.map((panel, index) => {
    panel.id ||= `part-${number}-${index}`;
    const tab = made("button", { type: "button", id: `${panel.id}-tab`, textContent: nameOf(panel), onclick: () => choose(index) });
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-controls", panel.id);
    return tab;
  });
  function choose(chosen) {
    tabs.forEach((tab, index) => {
      tab.setAttribute("aria-selected", index === chosen);
      tab.tabIndex = index === chosen ? 0 : -1;
      panels[index].classList.toggle("is-shown", index === chosen);
    });
  }
  list.addEventListener("keydown", (event) => {
    const now = tabs.indexOf(document.activeElement), last = tabs.length - 1;
    const next = { ArrowRight: now < last ? now + 1 : 0, ArrowLeft: now > 0 ? now - 1 : last, Home: 0, End: last }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    choose(next);
    tabs[next].focus();
  });
  function fit() {
    list.classList.toggle("narrow", PHONE.matches);
    columns.classList.toggle("narrow", PHONE.matches);
    for (const panel of panels) scrollable(panel);
  }
  list.append(...tabs);
  columns.before(list);
  choose(0);
  PHONE.addEventListener("change", fit);
  fit();
}

// What scrolls on its own can be reached by keyboard.
function scrollable(panel) {
  if (!panel.hasAttribute("tabindex") && panel.tagName !== "FORM") panel.tabIndex = 0;
}

document.addEventListener("DOMContentLoaded", () => {
  const bar = document.querySelector(".bar"), tools = document.querySelector(".tools");
  const measure = () => {
    document.documentElement.style.setProperty("--bar", `${bar.offsetHeight}px`);
    tools?.classList.toggle("is-tall", tools.offsetHeight > innerHeight / 6);
    if (tools) document.documentElement.style.setProperty("--tools", `${tools.classList.contains("is-tall") ? 0 : tools.offsetHeight}px`);
  };
  const watching = new ResizeObserver(measure);
  watching.observe(bar);
  if (tools) watching.observe(tools);
  document.querySelectorAll(".columns").forEach(tabbed);
});
