import { useEffect, useRef, useState } from "react";

import { now, useStore } from "../store/store";
import { sentBefore } from "../store/unsent";

interface Unsent<T> {
  /** What was typed and is not in the document yet; null where nothing is. */
  typed: T | null;
  type(value: T | null): void;
  send(): Promise<void>;
  /** Whether nothing is left to be sent. */
  isSettled: boolean;
  /** Whether it waits for a server that does not answer. */
  waits: boolean;
}

/**
 * What is typed into a field, until the document has it.
 *
 * A server that does not answer takes nothing: then what was typed stays, and is sent as soon as one answers. What the
 * server refuses is given up; it says why.
 *
 * @param value What the document has.
 * @param commit Changes the document; true once it is changed.
 */
export function useUnsent<T>(value: T, commit: (typed: T) => Promise<boolean>): Unsent<T> {
  const [typed, setTyped] = useState<T | null>(null);
  const [waits, setWaits] = useState(false);
  const [sent, setSent] = useState<T | null>(null);
  const onItsWay = useRef<{ typed: T; done: Promise<void> } | null>(null);
  const link = useStore((state) => state.link);
  const deliver = async (given: T): Promise<void> => {
    setSent(given);
    const isDone = given === value || (await commit(given));
    const isKept = !isDone && now().link !== "ok";
    setSent(null);
    setWaits(isKept);
    onItsWay.current = null;
    // What was typed while it was on its way is the next.
    if (!isKept) setTyped((present) => (present === given ? null : present));
  };
  const send = (): Promise<void> => {
    if (typed === null) return Promise.resolve();
    if (onItsWay.current?.typed === typed) return onItsWay.current.done;
    const done = deliver(typed);
    onItsWay.current = { typed, done };
    return done;
  };
  const newest = useRef(send);
  newest.current = send;
  useEffect(() => (typed === null ? undefined : sentBefore(() => newest.current())), [typed]);
  useEffect(() => {
    if (waits && link === "ok") void newest.current();
  }, [waits, link]);
  const type = (next: T | null): void => {
    setTyped(next);
    if (next === null) setWaits(false);
  };
  return { typed, type, send, isSettled: typed === null || typed === sent, waits };
}
