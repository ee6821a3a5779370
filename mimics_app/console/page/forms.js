// Forms of a participant before a session: which a study has, their fields by schema, and the answers.

import { mark, t, told } from "./texts.js";
import { setText, toast } from "./view.js";

const MOST_BYTES = 16000; // of a request that the page's server takes
const MOST_CHARACTERS = 2000; // of an answer
const byId = (id) => document.getElementById(id);
const TOO_LONG = mark("the answers are too long together");

export class Forms {
  #link;
  #kept; // called when answers, and with the first ones a new code, are kept
  #whose = null; // study and participant
  #add = false; // a new code, which the operator has confirmed
  #name = "";
  #fields = new Map(); // JSON pointer -> Field

  constructor(link, kept) {
    this.#link = link;
    this.#kept = kept;
    byId("answers").addEventListener("submit", (event) => { event.preventDefault(); this.#save(); });
    byId("close-form").addEventListener("click", () => { byId("answers").hidden = true; });
  }

  /** Forget whose forms were shown, and all answers. */
  close() {
    this.#whose = null;
    byId("forms").hidden = true;
    this.#clear();
  }

  /** Ask which forms a study has for a participant; a code that is new in it is confirmed first. */
  async open(study, participant) {
    this.close();
    const whose = { study, participant };
    this.#whose = whose;
    this.#add = false;
    const { done, why, forms, known } = await this.#ask({});
    if (this.#whose !== whose) return;
    if (!done) {
      toast(told(why));
      return;
    }
    byId("forms").hidden = false;
    if (known || Object.keys(forms).length === 0) this.#list(forms);
    else this.#confirm(forms);
  }

  #confirm(forms) {
    const add = this.#button(t("Add {code} to the study", { code: this.#whose.participant }), () => {
      this.#add = true;
      this.#list(forms);
    });
    const line = document.createElement("p");
    line.textContent = t("This code is not in the study yet. Is it right?");
    byId("forms-list").replaceChildren(line, add);
    add.focus();
  }

  #list(forms) {
    const buttons = Object.entries(forms).map(([name, title]) => this.#button(t(title), () => this.#show(name)));
    byId("forms-list").replaceChildren(...buttons);
    if (buttons.length) buttons[0].focus();
    else byId("forms-list").textContent = t("This study has no forms.");
  }

  #button(caption, act) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = caption;
    button.addEventListener("click", act);
    return button;
  }

  async #show(name) {
    this.#clear();
    const whose = this.#whose;
    const { done, why, form } = await this.#ask({ form: name, add: this.#add });
    if (this.#whose !== whose) return;
    if (!done) {
      toast(told(why));
      return;
    }
    this.#add = false;
    this.#name = name;
    setText(byId("answers-title"), t(form.title));
    const session = form.answered;
    setText(byId("answers-from"), session ? t("Answered before, last in session {session}; what is saved is kept beside it.", { session }) : "");
    const fields = Object.entries(form.items).map(([item, schema], i) => new Field(i, item, schema));
    this.#fields = new Map(fields.map((field) => [`/${field.name.replaceAll("~", "~0").replaceAll("/", "~1")}`, field]));
    byId("answers-items").replaceChildren(...fields.map((field) => field.node));
    byId("answers").hidden = false;
    fields[0].input.focus();
  }

  async #save() {
    const fields = [...this.#fields.values()];
    for (const field of fields) field.say(field.input.validity.badInput ? t("this is no number") : "");
    if (fields.some((field) => field.input.validity.badInput)) return;
    const whose = this.#whose;
    const request = { form: this.#name, answers: Object.fromEntries(fields.map((field) => [field.name, field.value])) };
    const bytes = new TextEncoder().encode(JSON.stringify(request)).length;
    byId("save-answers").disabled = true;
    const { done, why, faults = {} } = bytes > MOST_BYTES ? { done: false, why: TOO_LONG } : await this.#ask(request);
    byId("save-answers").disabled = false;
    if (this.#whose !== whose) return;
    if (done) {
      toast(t("The answers are kept."));
      this.#clear();
      this.#kept();
      return;
    }
    const faulty = Object.keys(faults).filter((pointer) => this.#fields.has(pointer));
    for (const pointer of faulty) this.#fields.get(pointer).say(told(faults[pointer]));
    setText(byId("answers-fault"), faulty.length ? t("Some answers are missing or cannot be taken.") : told(why));
    if (faulty.length) this.#fields.get(faulty[0]).input.focus();
  }

  #ask(more) {
    return this.#link.ask("form", { form: { ...this.#whose, ...more } });
  }

  #clear() {
    this.#fields.clear();
    byId("answers").hidden = true;
    byId("answers-items").replaceChildren();
    setText(byId("answers-fault"), "");
  }
}

/** One item of a form, from its number there and its schema: without an answer, as an earlier one would lead. */
class Field {
  #fault = document.createElement("small");
  #given = false;

  constructor(number, name, schema) {
    this.name = name;
    this.input = schema.kind === "choice" ? selectOf(schema) : inputOf(schema);
    this.input.required = schema.required ?? true;
    const label = document.createElement("label");
    const words = document.createElement("span");
    words.textContent = t(schema.label);
    label.append(words, this.input);
    if (schema.kind === "scale") {
      label.className = "slider";
      this.#watch(label);
    }
    const limits = document.createElement("small");
    limits.textContent = limitsOf(schema);
    limits.id = `limits-${number}`;
    this.#fault.className = "red";
    this.#fault.id = `fault-${number}`;
    this.input.setAttribute("aria-describedby", `${limits.id} ${this.#fault.id}`);
    this.node = document.createElement("div");
    this.node.append(label, limits, this.#fault);
  }

  /** What was answered, as text; "" for nothing: a scale that was not touched has no answer. */
  get value() {
    return this.input.type === "range" && !this.#given ? "" : this.input.value.trim();
  }

  /** Say what is wrong with the answer; "": nothing. */
  say(fault) {
    setText(this.#fault, fault);
    this.input.setAttribute("aria-invalid", String(fault !== ""));
  }

  #watch(label) {
    const shown = document.createElement("output");
    const show = () => setText(shown, this.#given ? this.input.value : t("not answered"));
    for (const kind of ["input", "click"]) this.input.addEventListener(kind, () => { this.#given = true; show(); });
    show();
    label.append(shown);
  }
}

function selectOf(schema) {
  const select = document.createElement("select");
  select.append(new Option("", ""), ...schema.choices.map((each) => new Option(t(each), each)));
  return select;
}

function inputOf(schema) {
  const input = document.createElement("input");
  input.type = { text: "text", number: "number", scale: "range" }[schema.kind ?? "text"];
  input.autocomplete = "off";
  if (input.type === "text") {
    input.maxLength = MOST_CHARACTERS;
    return input;
  }
  if (schema.low !== undefined) input.min = schema.low;
  if (schema.high !== undefined) input.max = schema.high;
  input.step = schema.step || "any";
  return input;
}

/** Limits of an item in words, and whether it may stay without an answer. */
function limitsOf(schema) {
  const end = (value, label) => [value ?? "…", label ? t(label) : ""].filter((part) => part !== "").join(" ");
  const bounded = schema.low !== undefined || schema.high !== undefined;
  const ends = bounded ? `${end(schema.low, schema.low_label)} – ${end(schema.high, schema.high_label)}` : "";
  return [ends, (schema.required ?? true) ? "" : t("may stay empty")].filter(Boolean).join(", ");
}
