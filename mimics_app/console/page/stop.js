// STOP: its own server and its own request, so that it works while the page's server hangs.

let address = "";

/** Set the address of STOP, which the page's server says once; it is kept for when that server is gone. */
export function setStopAddress(url) {
  address = url;
}

/** Take the force away; resolves to {stopped, why}. */
export async function stop() {
  if (!address) return { stopped: false, why: "the address of STOP is not known yet" };
  try {
    const answer = await fetch(address, {
      method: "POST",
      credentials: "include",
      keepalive: true,
      body: JSON.stringify({ nonce: crypto.randomUUID ? crypto.randomUUID() : `${performance.timeOrigin}-${performance.now()}-${Math.random()}` }),
    });
    return await answer.json();
  } catch {
    return { stopped: false, why: "STOP cannot be reached: use the switch of the robot" };
  }
}
