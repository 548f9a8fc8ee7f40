import { useEffect, useState } from "react";

import type { Checked, Path } from "../api/types";
import { check } from "./checks";
import { useForm } from "./context";
import { isNumber } from "./values";

const PAUSE = 160;

/** What the server says of a formula, a moment after it was typed; null while it has not answered. */
export function useChecked(path: Path, text: string): Checked | null {
  const [answer, setAnswer] = useState<{ text: string; checked: Checked } | null>(null);
  const place = JSON.stringify(path);
  const { draft } = useForm();
  useEffect(() => {
    if (text.trim() === "" || isNumber(text)) return undefined;
    let wanted = true;
    const timer = window.setTimeout(() => {
      check(JSON.parse(place) as Path, text, draft(JSON.parse(place) as Path))
        .then((checked) => wanted && setAnswer({ text, checked }))
        // A server that is gone has a banner of its own.
        .catch(() => undefined);
    }, PAUSE);
    return () => {
      wanted = false;
      window.clearTimeout(timer);
    };
  }, [place, text, draft]);
  return answer?.text === text ? answer.checked : null;
}
