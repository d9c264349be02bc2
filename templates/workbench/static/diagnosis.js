// The page of a diagnosis: a cause accepted, a suspicion tried alone, the next experiment.
import { ask, call, say, tell } from "./workbench.js";
import { planShown, watched } from "./experiment.js";

const page = document.getElementById("diagnosis"), { folder, file, plugin } = page.dataset, data = JSON.parse(page.dataset.data);
const own = plugin.endsWith(".py") ? [["plugin", plugin]] : [];

document.getElementById("accept")?.addEventListener("submit", async (event) => {
  event.preventDefault();
  const target = document.getElementById("target").value.trim();
  if (!await ask(`Write the extended inputs file to ${target} and open it?\n${file || "The inputs file"} stays as it is.`, "Write and open it")) return;
  try {
    const said = await call("/api/accept", { plugin, folder, file, target });
    location.href = `/edit?file=${encodeURIComponent(said.file)}`;
  } catch (error) { say(error.message); }
});

for (const button of document.querySelectorAll("[data-only]")) {
  button.onclick = async () => {
    try {
      const job = await call("/api/diagnose", { file, plugin, data, causes: button.dataset.only.split("|") });
      tell("This suspicion is fitted alone …");
      watched(job.ident, (done) => {
        const query = new URLSearchParams([["folder", done.folder], ["file", file], ...own, ...data.map((name) => ["data", name])]);
        location.href = `/measure/diagnosis?${query}`;
      });
    } catch (error) { say(error.message); }
  };
}

const experiment = document.getElementById("experiment");
const show = document.getElementById("show-plan");
if (show) show.onclick = () => planShown(document.getElementById("plan"), JSON.parse(experiment.content.textContent));
