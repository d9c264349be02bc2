// A job of this page that is waited for, and an experiment as a table to be taken away.
import { listen, made, say } from "./workbench.js";

const waiting = new Map();

// Call done(answer) once a job has ended well; say what is wrong where it has failed.
export function watched(ident, done) { waiting.set(ident, done); }

listen("", ({ jobs }) => {
  for (const job of jobs) {
    const done = waiting.get(job.ident);
    if (!done || job.status === "waits" || job.status === "runs") continue;
    waiting.delete(job.ident);
    if (job.status === "done") done(job.answer);
    else if (job.status === "failed") say(job.faults.map(({ message, file, line }) => [file && `${file}:${line ?? ""}`, message].filter(Boolean).join(" ")).join("\n"));
  }
});

export function planShown(place, experiment, sentences = []) {
  const said = sentences.map((text) => made("p", { textContent: text }));
  if (!experiment) { place.replaceChildren(...said); return; }
  const titles = ["", ...experiment.headers, ...experiment.results], isNumber = (index) => index > 0 && index <= experiment.headers.length;
  const head = made("thead", {}, made("tr", {}, ...titles.map((title, index) => made("th", { scope: "col", className: isNumber(index) ? "number" : "", textContent: title || "Reading" }))));
  const rows = experiment.rows.map((cells, index) => made("tr", {}, made("th", { scope: "row", textContent: index + 1 }),
    ...cells.map((cell) => made("td", { className: "number", textContent: cell })), ...experiment.results.map(() => made("td", { className: "quiet", textContent: "to be read" }))));
  const table = made("table", { className: "cells" }, made("caption", { textContent: "Readings to take" }), head, made("tbody", {}, ...rows));
  const box = made("div", { className: "scroll", tabIndex: 0 }, table);
  const { value, low, high } = experiment.chance, share = (each) => `${Math.round(100 * each)} %`;
  const chance = value === null || said.length ? "" : `The chance that it names the right one is ${share(value)} (95 %: ${share(low)} … ${share(high)}), simulated.`;
  const address = URL.createObjectURL(new Blob([experiment.csv], { type: "text/csv" }));
  place.replaceChildren(...said, made("p", { textContent: chance }), box,
    made("a", { className: "button", href: address, download: "experiment.csv", textContent: "Download as CSV" }),
    made("p", { className: "quiet", textContent: "Fill in what you read, bring the file back under Measure, and diagnose." }));
}
