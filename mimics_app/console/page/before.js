// Before a session: the choice, the lights of what it needs, the start and its override.

import { Forms } from "./forms.js";
import { People } from "./people.js";
import { mark, t } from "./texts.js";
import { setText, toast } from "./view.js";

const byId = (id) => document.getElementById(id);
const WORDS = { green: mark("ready"), amber: mark("works without"), red: mark("not ready") };
const INTERRUPTED = [["", mark("it was not")], ["resume", mark("resume at the next trial")], ["restart-block", mark("begin it again")]];
const OF_STUDY = ["choose-scene", "choose-difficulty", "choose-trials"];
const SIGNS = { green: "✓", amber: "!", red: "✗" };

export class Before {
  #link;
  #forms;
  #people;
  #lights = null;
  #asked = false;
  #may = true;

  constructor(link) {
    this.#link = link;
    this.#people = new People(link);
    this.#forms = new Forms(link, () => this.#people.ask());
    for (const value of [mark("usual"), mark("easier"), mark("harder")]) byId("choose-difficulty").append(new Option(t(value), value));
    for (const [value, text] of INTERRUPTED) byId("choose-interrupted").append(new Option(t(text), value));
    byId("choose-study").addEventListener("input", () => this.#people.list());
    for (const id of ["choose-study", "choose-participant", "new-participant"]) byId(id).addEventListener("input", () => { this.#suit(); this.#forms.close(); });
    byId("do-forms").addEventListener("click", () => this.#forms.open(this.choice().study, this.choice().participant));
    byId("do-check").addEventListener("click", () => this.check());
    byId("before-form").addEventListener("submit", (event) => { event.preventDefault(); this.start(); });
    byId("before-form").addEventListener("input", () => this.#forget());
  }

  /** Show the form while no session is attached. */
  show(shown) {
    byId("before").hidden = !shown;
    if (!shown) this.#forms.close();
    this.#forget();
    if (shown && !this.#asked) this.#fill();
    if (shown) this.#people.ask();
  }

  /** Let only the operator choose. */
  enable(may) {
    this.#may = may;
    if (!may) this.#forms.close();
    for (const node of byId("before-form").elements) node.disabled = !may;
    this.#suit();
  }

  /** What a study lays down cannot be chosen beside it. */
  #suit() {
    const chosen = byId("choose-study").value !== "";
    byId("of-study").hidden = !chosen;
    byId("do-forms").hidden = !chosen || this.#people.chosen === "";
    if (!chosen) byId("choose-interrupted").value = "";
    for (const id of OF_STUDY) byId(id).disabled = !this.#may || chosen;
  }

  async #fill() {
    this.#asked = true;
    const { done, choices } = await this.#link.ask("choices");
    this.#asked = done;
    if (!done) return;
    const scene = byId("choose-scene");
    scene.replaceChildren(...choices.scenes.map(({ name, title }) => new Option(t(title), name)));
    const devices = choices.devices.map(({ name, title }) => new Option(t(title || name), name));
    byId("choose-device").replaceChildren(new Option(t("usual for the scene"), ""), ...devices);
    const displays = choices.displays.map(({ name, title }) => new Option(t(title || name), name));
    byId("choose-display").replaceChildren(new Option(t("usual for the scene"), ""), ...displays);
  }

  choice() {
    return {
      scene: byId("choose-scene").value, participant: this.#people.chosen, device: byId("choose-device").value,
      display: byId("choose-display").value,
      study: byId("choose-study").value, interrupted: byId("choose-interrupted").value,
      difficulty: byId("choose-difficulty").value, trials: Number(byId("choose-trials").value) || 0, physio: byId("choose-physio").value.trim(),
    };
  }

  /** Ask for the lights and show them; returns them. */
  async check() {
    setText(byId("do-check"), t("Checking …"));
    const { done, why, lights } = await this.#link.ask("check", { choice: this.choice() });
    setText(byId("do-check"), t("Check"));
    if (!done) {
      toast(t(why));
      return null;
    }
    this.#lights = lights;
    byId("lights").replaceChildren(...lights.map((light) => {
      const line = document.createElement("li");
      line.className = light.light;
      const remedy = light.remedy ? ` – ${t(light.remedy)}` : "";
      line.textContent = `${SIGNS[light.light]} ${t(light.name)} (${t(WORDS[light.light])}): ${t(light.found)}${remedy}`;
      return line;
    }));
    setText(byId("do-start"), this.#red().length ? t("Start all the same") : t("Start session"));
    return lights;
  }

  /** Start: after a check only, and with red lights only when it is asked once more. */
  async start() {
    const checked = this.#lights !== null;
    if (!checked && !(await this.check())) return;
    if (!checked && this.#red().length) return;
    const despite = this.#red().map((light) => `${light.name}: ${light.found}`).join("; ").slice(0, 300);
    const { done, why } = await this.#link.ask("start", { choice: { ...this.choice(), despite } });
    toast(done ? t("The session starts; this takes some seconds.") : t(why));
  }

  #red() {
    return (this.#lights || []).filter((light) => light.light === "red");
  }

  #forget() {
    this.#lights = null;
    byId("lights").replaceChildren();
    setText(byId("do-start"), t("Start session"));
  }
}
