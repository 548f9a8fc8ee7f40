/** Requests to the server, each with the token, each refusal as an exception. */

import type { Document, Fault, NativeFile } from "./types";

const STORED = "symofros-token";

/** The token of the page's address; kept for this tab, so that a reload needs no address, and taken out of the bar. */
function readToken(): string {
  const address = new URL(window.location.href);
  const given = address.searchParams.get("token");
  if (given !== null) {
    sessionStorage.setItem(STORED, given);
    address.searchParams.delete("token");
    window.history.replaceState(null, "", address);
  }
  return sessionStorage.getItem(STORED) ?? "";
}

const token = readToken();

export function withToken(address: string): string {
  return `${address}${address.includes("?") ? "&" : "?"}token=${encodeURIComponent(token)}`;
}

export interface Refusal {
  error?: Fault;
  /** Of a stale change: the document as it is now. */
  document?: Document;
  /** Of a save onto a changed file: its text, and what names that state. */
  disk?: string;
  over?: string;
  /** Of a run that needs consent: the files whose native code would run. */
  native?: NativeFile[];
}

/** The server answered, and said no. */
export class Refused extends Error {
  constructor(
    readonly status: number,
    readonly fault: Fault,
    readonly body: Refusal,
  ) {
    super(`${fault.object}: ${fault.found}`);
  }
}

/** Nobody answered. */
export class Unreachable extends Error {}

const UNEXPLAINED: Fault = {
  object: "the server's answer",
  found: "no explanation",
  rule: "a refusal says why",
  remedy: "look at what `symofros edit` printed",
};

/** The content of a file. */
export async function download(address: string): Promise<Blob> {
  let answer: Response;
  try {
    answer = await fetch(address, { headers: { Authorization: `Bearer ${token}` } });
  } catch {
    throw new Unreachable(address);
  }
  if (answer.ok) return answer.blob();
  const refusal = (await answer.json().catch(() => ({}))) as Refusal;
  throw new Refused(answer.status, refusal.error ?? UNEXPLAINED, refusal);
}

async function request<T>(method: string, address: string, body?: unknown): Promise<T> {
  const headers: Record<string, string> = { Authorization: `Bearer ${token}` };
  if (body !== undefined) headers["Content-Type"] = "application/json";
  let answer: Response;
  try {
    answer = await fetch(address, { method, headers, body: body === undefined ? null : JSON.stringify(body) });
  } catch {
    throw new Unreachable(address);
  }
  const parsed: unknown = await answer.json().catch(() => ({}));
  if (answer.ok) return parsed as T;
  const refusal = parsed as Refusal;
  throw new Refused(answer.status, refusal.error ?? UNEXPLAINED, refusal);
}

export const get = <T>(address: string): Promise<T> => request<T>("GET", address);
export const post = <T>(address: string, body: unknown): Promise<T> => request<T>("POST", address, body);
export const remove = <T>(address: string): Promise<T> => request<T>("DELETE", address);
