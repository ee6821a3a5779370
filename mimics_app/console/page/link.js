// Connection to the page's server: entering with the token of the address, binary and text messages, reconnecting.

const RETRY_MS = 1000;
const SILENT_MS = 900; // without any message for this long, the connection counts as lost

/** Exchange the token in the fragment for a cookie; the fragment is then taken out of the address and its history. */
export async function enter() {
  const token = location.hash.slice(1);
  if (!token) return "";
  history.replaceState(null, "", location.pathname);
  const answer = await fetch("enter", {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ token }),
  });
  return answer.ok ? "" : "refused";
}

/** One connection that opens itself again; `handlers` has opened, lost, text and binary. */
export class Link {
  #handlers;
  #socket = null;
  #heard = 0;
  #next = 0;
  #waiting = new Map();
  #lost = true;

  constructor(handlers) {
    this.#handlers = handlers;
    this.#open();
    setInterval(() => this.#check(), 200);
  }

  /** Send a command to the session; resolves to its answer {done, why}. */
  command(command) {
    return this.#send({ command });
  }

  /** Ask the server for something by name; resolves to its answer. */
  ask(ask, more = {}) {
    return this.#send({ ask, ...more });
  }

  #send(content) {
    if (this.#lost || this.#socket.readyState !== WebSocket.OPEN) {
      return Promise.resolve({ done: false, why: "not connected" });
    }
    const id = ++this.#next;
    this.#socket.send(JSON.stringify({ id, ...content }));
    return new Promise((resolve) => this.#waiting.set(id, resolve));
  }

  #open() {
    const address = new URL("live", location.href);
    address.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    address.hash = "";
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.#take(event.data);
    socket.onclose = () => {
      this.#lose();
      setTimeout(() => this.#open(), RETRY_MS);
    };
    this.#socket = socket;
  }

  #take(data) {
    this.#heard = performance.now();
    if (this.#lost) {
      this.#lost = false;
      this.#handlers.opened();
    }
    if (data instanceof ArrayBuffer) {
      this.#handlers.binary(data);
      return;
    }
    const message = JSON.parse(data);
    if (message.kind !== "answer") {
      this.#handlers.text(message);
      return;
    }
    const resolve = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    if (resolve) resolve(message);
  }

  #check() {
    if (!this.#lost && performance.now() - this.#heard > SILENT_MS) this.#lose();
  }

  #lose() {
    if (!this.#lost) {
      this.#lost = true;
      this.#handlers.lost();
    }
    for (const resolve of this.#waiting.values()) resolve({ done: false, why: "the connection was lost" });
    this.#waiting.clear();
  }
}
