// The page: joins connection, steering, plots and texts.

import { Before } from "./before.js";
import { enter, Link } from "./link.js";
import { BandPlot, SignalPlot } from "./plots.js";
import { Steering } from "./steering.js";
import { setStopAddress } from "./stop.js";
import { loadTexts, t } from "./texts.js";
import * as view from "./view.js";

const TELEMETRY = 1, PICTURE = 2, SIGNALS = 3, SECOND_PICTURE = 4;
const HEADER = 8;
const STILL_MS = 700; // ticks that come no more for this long: the application hangs or is gone

const byId = (id) => document.getElementById(id);

class Page {
  constructor() {
    this.names = [];
    this.values = {};
    this.status = null;
    this.card = null;
    this.startNs = 0;
    this.tickAt = 0;
    this.frames = [];
    this.bodyPlots = [];
    this.bands = [
      ["force", new BandPlot(byId("plot-force"), t("Force on the person"), "N", "--force")],
      ["speed", new BandPlot(byId("plot-speed"), t("Speed of the hand"), "cm/s", "--speed", 100)],
      ["distance", new BandPlot(byId("plot-distance"), t("Distance from the path"), "mm", "--distance", 1000)],
    ];
    this.link = new Link({
      opened: () => this.opened(), lost: () => this.lost(),
      text: (message) => this.take(message), binary: (data) => this.takeBinary(data),
    });
    this.steering = new Steering(this.link);
    this.before = new Before(this.link);
    this.lost();
    const draw = () => { this.draw(); requestAnimationFrame(draw); };
    requestAnimationFrame(draw);
    setInterval(() => this.slow(), 250);
  }

  opened() {
    document.body.classList.remove("stale");
    this.link.ask("picture_on");
    this.showLink();
  }

  lost() {
    document.body.classList.add("stale");
    view.showConnection(t("Page's server lost; it is sought again"), "bad");
  }

  showLink() {
    if (document.body.classList.contains("stale")) return;
    if (!this.card) view.showConnection(t("No session; the page waits for one"), "warn");
    else if (performance.now() - this.tickAt > STILL_MS) view.showConnection(t("The application does not answer"), "bad");
    else view.showConnection(t("Live"), "calm");
  }

  take(message) {
    const takes = {
      hello: () => { this.names = message.values; setStopAddress(message.stop); },
      session: () => this.takeSession(message),
      status: () => this.takeStatus(message.status),
      roles: () => { view.showRoles(message); this.steering.setRoles(message); this.before.enable(message.operates); },
      events: () => view.addEvents(message.entries, this.startNs || (this.startNs = message.entries[0]?.t_ns ?? 0)),
      trials: () => view.addTrials(message.entries),
    };
    takes[message.kind]?.();
  }

  takeSession({ card, why, orderly }) {
    this.card = card;
    this.status = null;
    this.startNs = 0;
    this.tickAt = performance.now();
    view.showSession(card);
    view.showAlarm(card ? "" : t(why), orderly);
    this.steering.setSession(card);
    this.before.show(!card);
    byId("columns").hidden = !card;
    for (const [, plot] of this.bands) plot.clear();
    view.hidePictures();
    byId("body").hidden = !(card && card.signals.length);
    byId("body-plots").replaceChildren();
    this.bodyPlots = (card ? card.signals : []).map((name) => ({ name, plot: null }));
    this.showLink();
  }

  takeStatus(status) {
    if (!status.task) return;
    this.status = status;
    view.showStatus(status);
    this.steering.setStatus(status);
  }

  takeBinary(data) {
    const kind = new DataView(data).getUint32(0, true);
    if (kind === PICTURE) view.showPicture(new Uint8Array(data, HEADER));
    const second = byId("second").value;
    if (kind === SECOND_PICTURE && second) view.showSecondPicture(new Uint8Array(data, HEADER), second);
    if (kind === SIGNALS) this.takeSignals(new DataView(data, HEADER));
    if (kind !== TELEMETRY || data.byteLength === HEADER) return;
    const numbers = new Float64Array(data, HEADER);
    this.names.forEach((name, i) => { this.values[name] = numbers[i]; });
    this.tickAt = performance.now();
    this.frames.push(this.tickAt);
    if (this.frames.length > 120) this.frames.shift();
    for (const [name, plot] of this.bands) plot.add(this.values.t_s, this.values[`${name}_low`], this.values[`${name}_high`]);
    this.fresh = true;
  }

  takeSignals(data) {
    for (let at = 0; at < data.byteLength; at += 16) {
      const seconds = Number(data.getBigInt64(at, true)) / 1e9;
      const body = this.bodyPlots[data.getInt16(at + 12, true)];
      if (!body) continue;
      if (!body.plot) {
        const place = document.createElement("div");
        place.className = "plot";
        byId("body-plots").append(place);
        body.plot = new SignalPlot(place, body.name.toUpperCase(), "", "--ecg");
        body.begin = seconds;
      }
      if (data.getInt16(at + 14, true)) body.plot.mark(seconds - body.begin);
      else body.plot.add(seconds - body.begin, data.getFloat32(at + 8, true));
    }
    this.freshBody = true;
  }

  rate() {
    const span = this.frames.length > 1 ? this.frames[this.frames.length - 1] - this.frames[0] : 0;
    return span ? (1000 * (this.frames.length - 1)) / span : 0;
  }

  draw() {
    if (this.fresh) for (const [, plot] of this.bands) plot.draw();
    if (this.freshBody) for (const { plot } of this.bodyPlots) plot?.draw();
    this.fresh = this.freshBody = false;
  }

  slow() {
    this.showLink();
    if (!this.status || this.values.t_s === undefined) return;
    view.showNumbers(this.values, this.rate());
    view.showMachine(this.values, this.status, this.rate());
  }
}

await loadTexts();
if ((await enter()) === "refused") view.showAlarm(t("The token of this address is not valid: use the address that the program printed."));
new Page();
