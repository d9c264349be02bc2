// What every page uses: calls, sentences, jobs.

export async function call(address, body) {
  const answer = await fetch(address, { method: "POST", headers: { "content-type": "application/json" }, body: JSON.stringify(body) });
  const said = await answer.json();
  if (answer.status === 409 && said.confirm) {
    if (!confirm(`${said.confirm} is a program. Run it? Say yes only if you know where it comes from.`)) throw new Faults(said.faults);
    await call("/api/confirm", { file: said.confirm });
    return call(address, body);
  }
  if (!answer.ok && answer.status !== 409) throw new Faults(said.faults);
  return said;
}

export class Faults extends Error {
  constructor(faults) { super(faults.map((fault) => fault.message).join("\n")); this.faults = faults; }
}

export function say(text) { document.getElementById("said").textContent = text; }

export function listen(file, heard) {
  const source = new EventSource(`/events?file=${encodeURIComponent(file)}`);
  source.onmessage = (event) => { const seen = JSON.parse(event.data); showJobs(seen.jobs); heard(seen); };
}

function showJobs(jobs) {
  const shown = document.getElementById("jobs");
  shown.replaceChildren(...jobs.filter((job) => job.status === "runs" || job.status === "waits").map((job) => {
    const line = document.createElement("span");
    const share = job.total ? ` ${Math.round(100 * job.done / job.total)} %` : "";
    line.textContent = `${job.title}: ${job.stage}${share} `;
    const stop = document.createElement("button");
    stop.textContent = "Cancel";
    stop.onclick = () => call("/api/cancel", { job: job.ident }).catch((error) => say(error.message));
    line.append(stop);
    return line;
  }));
}

if (!document.getElementById("edit")) listen("", () => {});
