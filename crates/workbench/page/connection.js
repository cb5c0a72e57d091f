// @ts-check
// Changes of other tabs, and a server that ends and comes back.

import { load, on, state } from "./store.js";

const RETRY_MS = 1500;

let timer = 0;

function listen() {
  const events = new EventSource("api/events");
  events.addEventListener("session", (event) => {
    const { revision } = JSON.parse(/** @type {MessageEvent<string>} */ (event).data);
    // Our own changes have arrived with their answers.
    if (revision > (state.session?.revision ?? 0)) setTimeout(() => {
      if (revision > (state.session?.revision ?? 0)) void load();
    }, 60);
  });
  events.addEventListener("open", () => {
    if (state.isLost) void load();
  });
  events.addEventListener("error", () => {
    // The browser tries again by itself unless the answer was none of a stream; asking says whether the server is there.
    if (events.readyState === EventSource.CLOSED) {
      clearTimeout(timer);
      timer = window.setTimeout(listen, RETRY_MS);
    }
    if (!state.isLost) void load();
  });
}

export function startConnection() {
  listen();
  const again = () => {
    if (!state.isLost) return;
    void load().finally(() => setTimeout(again, RETRY_MS));
  };
  on("lost", () => setTimeout(again, RETRY_MS));
}
