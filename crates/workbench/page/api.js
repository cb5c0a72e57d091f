// @ts-check
// The only module that talks to the server. Addresses are relative, because the page lives below a token.

import { decoded } from "./rows.js";

/** @typedef {import("./rows.js").Rows} Rows */
/** @typedef {import("./types.js").Session} Session */

/** A refusal of the server: its sentence, and at which part of the page it belongs. */
export class Refusal extends Error {
  /** @param {string} says @param {string} where @param {number} status */
  constructor(says, where, status) {
    super(says);
    this.where = where;
    this.status = status;
  }
}

const ENDED = "bulge open has ended. Start it again: with --session FOLDER this page goes on, else open the address that it prints.";

/** Nobody answers: `bulge open` has ended. */
export class Lost extends Error {}

/** @param {unknown} error */
export const isAborted = (error) => error instanceof DOMException && error.name === "AbortError";

/**
 * @param {string} path
 * @param {RequestInit} [options]
 * @returns {Promise<Response>}
 */
async function ask(path, options) {
  let answer;
  try {
    answer = await fetch(`api/${path}`, { cache: "no-store", ...options });
  } catch (error) {
    if (isAborted(error)) throw error;
    throw new Lost(ENDED);
  }
  if (answer.ok) return answer;
  const text = await answer.text();
  /** @type {{error?: string, where?: string}} */
  let said = {};
  try {
    said = JSON.parse(text);
  } catch {
    // An answer that is no JSON comes from something in between; the status says enough.
  }
  throw new Refusal(said.error ?? `the server answered with status ${answer.status}`, said.where ?? "request", answer.status);
}

/** @param {string} path @param {AbortSignal} [signal] @returns {Promise<any>} */
export async function get(path, signal) {
  return (await ask(path, { signal })).json();
}

/** @param {Record<string, unknown>} change @returns {Promise<Session>} */
export async function putSession(change) {
  const headers = { "Content-Type": "application/json" };
  return (await ask("session", { method: "PUT", headers, body: JSON.stringify(change) })).json();
}

/** @param {string} path @param {BodyInit} [body] @param {AbortSignal} [signal] @returns {Promise<any>} */
export async function post(path, body, signal) {
  const headers = { "Content-Type": typeof body === "string" ? "text/plain; charset=utf-8" : "application/octet-stream" };
  return (await ask(path, { method: "POST", headers, body, signal })).json();
}

/** All rows, as one array for each column. @param {AbortSignal} [signal] @returns {Promise<Rows>} */
export async function getRows(signal) {
  return decoded(await (await ask("rows", { signal })).arrayBuffer());
}

/**
 * Reads the stream of a diagnosis until its result; aborting the signal cancels it on the server.
 *
 * @param {AbortSignal} signal
 * @param {(progress: {share: number, what: string}) => void} onProgress
 * @returns {Promise<any>}
 */
export async function diagnose(signal, onProgress) {
  const answer = await ask("diagnose", { method: "POST", signal });
  if (!answer.body) throw new Lost("the answer has no body");
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    let part;
    try {
      part = await reader.read();
    } catch (error) {
      if (isAborted(error)) throw error;
      throw new Lost(ENDED);
    }
    if (part.done) throw new Lost(ENDED);
    rest = (rest + part.value).replaceAll("\r\n", "\n");
    for (let end = rest.indexOf("\n\n"); end >= 0; end = rest.indexOf("\n\n")) {
      const event = parseEvent(rest.slice(0, end));
      rest = rest.slice(end + 2);
      if (event.kind === "progress") onProgress(JSON.parse(event.data));
      if (event.kind === "result") return JSON.parse(event.data);
      if (event.kind === "failed") throw new Refusal(JSON.parse(event.data).error, "request", 422);
    }
  }
}

/** @param {string} text one event of a stream */
function parseEvent(text) {
  let kind = "message";
  const data = [];
  for (const line of text.split("\n")) {
    if (line.startsWith("event:")) kind = line.slice(6).trim();
    if (line.startsWith("data:")) data.push(line.slice(5).replace(/^ /, ""));
  }
  return { kind, data: data.join("\n") };
}
