// What the operator does: buttons, keys, sliders, notes, marks, the policy; each shows the session's answer.

import { stop } from "./stop.js";
import { mark, t } from "./texts.js";
import { figure, setText, toast } from "./view.js";

const byId = (id) => document.getElementById(id);

const TRIAL = [
  ["start_trial", mark("Start"), "S"], ["pause", mark("Pause"), "P"], ["resume", mark("Resume"), "P"], ["skip", mark("Skip"), ""],
  ["repeat", mark("Repeat"), ""], ["reset", mark("Force on again"), "R"], ["end", mark("End session"), ""],
];
const MARKS = [mark("event"), mark("pain"), mark("fatigue"), mark("help")];
const SURE_MS = 4000;

/** Return a number with as many digits as it needs, three at most. */
function plain(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(3))) : "–";
}

export class Steering {
  #link;
  #card = null;
  #status = null;
  #operates = false;
  #sliders = new Map();
  #buttons = new Map();

  constructor(link) {
    this.#link = link;
    byId("stop").addEventListener("click", () => this.stop());
    for (const [command, caption, key] of TRIAL) this.#addTrialButton(command, caption, key);
    MARKS.forEach((name, i) => this.#button(byId("marks"), `${t(name)} (${i + 1})`, () => this.give({ command: "mark", name })));
    byId("note-form").addEventListener("submit", (event) => this.#note(event));
    byId("role-ask").addEventListener("click", () => this.#askRole());
    const volume = byId("volume");
    volume.addEventListener("change", () => this.give({ command: "volume", level: Number(volume.value) }));
    volume.addEventListener("input", () => setText(volume.nextElementSibling, `${Math.round(100 * volume.value)} %`));
    byId("second").addEventListener("change", () => this.#look());
    document.addEventListener("keydown", (event) => this.#key(event));
    this.#button(byId("fault-buttons"), t("Let it happen"), () => this.give({ command: "fault", name: byId("fault").value }));
    this.#button(byId("fault-buttons"), t("End the fault"), () => this.give({ command: "fault", name: "none" }));
    this.#policy();
    this.#enable();
  }

  /** STOP: to its own server, and beside it over the socket, so that one that hangs does not matter. */
  async stop() {
    byId("stop").classList.add("pressed");
    setTimeout(() => byId("stop").classList.remove("pressed"), 600);
    const answer = await stop();
    if (!answer.stopped) {
      const second = await this.#link.command({ command: "stop" });
      if (!second.done) toast(t(answer.why));
    }
  }

  /** Give a command and show a refusal or remark. */
  async give(command) {
    const answer = await this.#link.command(command);
    if (!answer.done) toast(t("Refused: {why}", { why: t(answer.why) }));
    else if (answer.why) toast(answer.why);
    return answer;
  }

  setSession(card) {
    this.#card = card;
    this.#status = null;
    this.#sliders.clear();
    byId("sliders").replaceChildren();
    for (const slider of card ? card.sliders : []) this.#addSlider(slider);
    byId("views").replaceChildren();
    for (const name of card && card.views.length > 1 ? card.views : []) {
      const button = this.#button(byId("views"), name, () => this.give({ command: "view", name }));
      button.dataset.view = name;
    }
    byId("second").replaceChildren(new Option(t("none"), ""), ...(card ? card.second_views : []).map((name) => new Option(t(name), name)));
    const faults = Object.entries(card ? card.faults : {}).filter(([name]) => name !== "none");
    byId("fault").replaceChildren(...faults.map(([name, words]) => new Option(t(words), name)));
    byId("faults").hidden = !faults.length;
    byId("policy").hidden = !(card && card.has_policy);
    this.#enable();
  }

  setRoles(roles) {
    this.#operates = roles.operates;
    const ask = byId("role-ask");
    const asked = roles.operates && roles.asking !== null;
    ask.hidden = !(asked || (roles.may_operate && !roles.operates));
    ask.dataset.ask = asked ? "hand_over" : "operate";
    const mine = roles.asking === roles.client;
    setText(ask, asked ? t("Hand over to page {n}", { n: roles.asking }) : mine ? t("Take over now") : t("Operate"));
    this.#enable();
  }

  setStatus(status) {
    this.#status = status;
    const task = status.task;
    this.#buttons.get("pause").hidden = task.paused;
    this.#buttons.get("resume").hidden = !task.paused;
    this.#buttons.get("reset").hidden = !["SAFE_STOP", "E_STOP"].includes(status.safety.state);
    for (const [name, { input, output, unit }] of this.#sliders) {
      const value = status.values[name];
      if (document.activeElement !== input) input.value = value;
      setText(output, `${t("now")} ${plain(value)} ${unit}`);
    }
    const second = byId("second");
    const volume = byId("volume");
    if (document.activeElement !== volume && Number(volume.value) !== status.volume) {
      volume.value = status.volume;
      setText(volume.nextElementSibling, `${Math.round(100 * status.volume)} %`);
    }
    if (document.activeElement !== second) second.value = status.second_view;
    if (!status.second_view) byId("second-image").hidden = true;
    for (const button of byId("views").children) button.setAttribute("aria-pressed", `${button.dataset.view === status.view}`);
    this.#showPolicy(status.policy);
  }

  #addTrialButton(command, caption, key) {
    const dangerous = command === "end";
    const button = this.#button(byId("trial-buttons"), key ? `${t(caption)} (${key})` : t(caption), () => {
      if (dangerous && !button.dataset.sure) {
        button.dataset.sure = "yes";
        setText(button, t("End? Press once more"));
        setTimeout(() => { delete button.dataset.sure; setText(button, t(caption)); }, SURE_MS);
        return;
      }
      this.give({ command });
    });
    button.id = `do-${command}`;
    if (dangerous) button.className = "danger";
    if (key) button.setAttribute("aria-keyshortcuts", key);
    this.#buttons.set(command, button);
  }

  #button(place, caption, act) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = caption;
    button.addEventListener("click", act);
    place.append(button);
    return button;
  }

  #addSlider({ name, low, high, step, unit, between }) {
    const label = document.createElement("label");
    label.className = "slider";
    const caption = document.createElement("span");
    caption.textContent = t(name.replaceAll("_", " "));
    const limits = document.createElement("small");
    limits.textContent = `${plain(low)} … ${plain(high)}${unit === "-" ? "" : ` ${unit}`}${between ? `, ${t("from the next trial on")}` : ""}`;
    caption.append(limits);
    const input = Object.assign(document.createElement("input"), { type: "range", min: low, max: high, step: step || (high - low) / 100 });
    const output = document.createElement("output");
    input.addEventListener("change", () => {
      this.give({ command: "set_parameter", name, value: Number(input.value) });
      input.blur();
    });
    input.addEventListener("input", () => setText(output, `${t("new")} ${figure(Number(input.value), 2)}`));
    label.append(caption, input, output);
    byId("sliders").append(label);
    this.#sliders.set(name, { input, output, unit: unit === "-" ? "" : unit });
  }

  #policy() {
    const place = byId("policy");
    const title = document.createElement("h3");
    title.textContent = t("The computer's choices");
    const modes = document.createElement("div");
    modes.className = "buttons";
    for (const [mode, caption] of [["on", mark("carried out")], ["propose", mark("proposed to me")], ["off", mark("ignored")]]) {
      this.#button(modes, t(caption), () => this.give({ command: "policy", mode })).dataset.mode = mode;
    }
    const choice = Object.assign(document.createElement("p"), { id: "policy-choice", className: "quiet" });
    const confirm = Object.assign(document.createElement("div"), { id: "policy-confirm", className: "buttons", hidden: true });
    this.#button(confirm, t("Accept (Y)"), () => this.give({ command: "confirm", accept: true }));
    this.#button(confirm, t("Drop"), () => this.give({ command: "confirm", accept: false }));
    place.append(title, modes, choice, confirm);
    place.hidden = true;
  }

  #showPolicy({ mode, proposal, choice }) {
    for (const button of byId("policy").querySelectorAll("[data-mode]")) button.setAttribute("aria-pressed", `${button.dataset.mode === mode}`);
    const words = (values) => Object.entries(values).map(([name, value]) => `${name} ${figure(value, 2)}`).join(", ");
    let text = t("no choice yet");
    if (choice) {
      text = `${t("last choice")}: ${words(choice.values)}; ${t("probability")} ${figure(choice.propensity, 2)}`;
      if (choice.reward !== null && choice.reward !== undefined) text += `, ${t("value of the trial before")} ${figure(choice.reward, 2)}`;
    }
    if (proposal) text = `${t("proposed")}: ${words(proposal.values)}`;
    setText(byId("policy-choice"), text);
    byId("policy-confirm").hidden = !proposal;
  }

  async #note(event) {
    event.preventDefault();
    const text = byId("note").value.trim();
    if (!text) return;
    const answer = await this.give({ command: "note", text });
    if (answer.done) byId("note").value = "";
    byId("note").blur();
  }

  async #look() {
    const answer = await this.#link.ask("look", { view: byId("second").value });
    byId("second-image").hidden = true;
    if (!answer.done) toast(t(answer.why));
  }

  async #askRole() {
    const answer = await this.#link.ask(byId("role-ask").dataset.ask);
    if (!answer.done) toast(t(answer.why));
  }

  #key(event) {
    const typing = event.target instanceof HTMLSelectElement || (event.target instanceof HTMLInputElement && event.target.type !== "range");
    if (typing && event.key === "Escape") event.target.blur();
    if (typing || event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    const paused = this.#status && this.#status.task.paused;
    const keys = {
      " ": () => this.stop(),
      p: () => this.give({ command: paused ? "resume" : "pause" }),
      s: () => this.give({ command: "start_trial" }),
      r: () => this.give({ command: "reset" }),
      n: () => byId("note").focus(),
      y: () => { if (!byId("policy-confirm").hidden) this.give({ command: "confirm", accept: true }); },
    };
    MARKS.forEach((name, i) => { keys[`${i + 1}`] = () => this.give({ command: "mark", name }); });
    const act = keys[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act();
  }

  #enable() {
    const may = this.#operates && this.#card !== null;
    for (const node of document.querySelectorAll("#columns button, #columns input, #columns select")) node.disabled = !may;
    byId("stop").disabled = false;
  }
}
