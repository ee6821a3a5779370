// Studies of the page's folder and their participants: who is known is chosen, who is new gets a code.

import { t } from "./texts.js";

const byId = (id) => document.getElementById(id);
const NEW = "new"; // the values of known codes are their numbers in the list

export class People {
  #link;
  #studies = {}; // name -> codes
  #recorded = []; // codes of recordings of no study
  #listed = []; // codes in the order of the list

  constructor(link) {
    this.#link = link;
    byId("choose-participant").addEventListener("input", () => this.#showNew());
    this.list();
  }

  /** The code that is chosen or typed; "": none. */
  get chosen() {
    const { value } = byId("choose-participant");
    return value === NEW ? byId("new-participant").value.trim() : value === "" ? "" : this.#listed[Number(value)];
  }

  /** Ask who is known by now, and list them. */
  async ask() {
    const { done, people } = await this.#link.ask("people");
    if (!done) return;
    this.#studies = people.studies;
    this.#recorded = people.recorded;
    const study = byId("choose-study");
    const chosen = study.value;
    study.replaceChildren(new Option(t("none"), ""), ...Object.keys(this.#studies).map((name) => new Option(name, name)));
    study.value = chosen in this.#studies ? chosen : "";
    this.list();
  }

  /** List the codes of the chosen study first, then all others; who was chosen stays so. */
  list() {
    const { chosen } = this;
    const isNew = byId("choose-participant").value === NEW;
    const study = byId("choose-study").value;
    const own = this.#studies[study] || [];
    const others = [...new Set([...Object.values(this.#studies).flat(), ...this.#recorded])].filter((code) => !own.includes(code));
    this.#listed = [...own, ...others];
    const options = this.#listed.map((code, i) => new Option(code, i));
    const groups = [[t("In this study"), options.slice(0, own.length)], [t("Not in this study yet"), options.slice(own.length)]];
    const grouped = groups.filter(([, each]) => each.length).map(([label, each]) => groupOf(label, each));
    const list = byId("choose-participant");
    list.replaceChildren(new Option(t("without a code"), ""), new Option(t("new: enter a code"), NEW), ...(study ? grouped : options));
    const place = this.#listed.indexOf(chosen);
    list.value = place >= 0 ? place : isNew ? NEW : "";
    this.#showNew();
  }

  /** Show where a new code is typed; the list keeps the focus, which the arrow keys pass through it. */
  #showNew() {
    const isNew = byId("choose-participant").value === NEW;
    byId("of-new").hidden = !isNew;
    if (!isNew) byId("new-participant").value = "";
  }
}

function groupOf(label, options) {
  const group = document.createElement("optgroup");
  group.label = label;
  group.append(...options);
  return group;
}
