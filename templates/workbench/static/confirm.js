// A page of a program that nobody has confirmed yet: once it is, the page itself follows.
import { call, say } from "./workbench.js";

const confirm = document.getElementById("confirm");
confirm.onclick = async () => {
  try {
    await call("/api/confirm", { file: confirm.dataset.file });
    location.reload();
  } catch (error) { say(error.message); }
};
