import { call, say } from "./workbench.js";

for (const form of document.querySelectorAll("form[data-begin]")) {
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    try {
      const { file } = await call("/api/begin", { plugin: form.dataset.begin, file: form.elements.file.value });
      location.href = `/edit?file=${encodeURIComponent(file)}`;
    } catch (error) { say(error.message); }
  });
}
