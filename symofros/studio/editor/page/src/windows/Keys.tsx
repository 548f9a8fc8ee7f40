import { Window } from "../shell/Window";
import { dismiss } from "../store/store";

const KEYS = [
  ["Tab", "next block or link"],
  ["Enter", "properties of the chosen block or link (also double click)"],
  ["Arrows", "move the chosen blocks"],
  ["F", "fold what the chosen bodies carry into them, and back"],
  ["Ctrl G", "group the chosen blocks of a diagram into a subsystem"],
  ["Delete", "remove what is chosen"],
  ["Ctrl Z, Ctrl Y", "undo, redo"],
  ["Ctrl C, Ctrl X, Ctrl V", "copy, cut, paste bodies, links or blocks, also in another document"],
  ["Ctrl D", "duplicate what is chosen"],
  ["Ctrl A", "choose all blocks"],
  ["Ctrl K or /", "find by name"],
  ["Ctrl S, Ctrl O", "save, open"],
  ["Shift and drag", "choose the blocks in a rectangle"],
  ["?", "this list"],
] as const;

export function Keys() {
  return (
    <Window title="Keys" onClose={dismiss}>
      <dl className="keys">
        {KEYS.map(([keys, what]) => (
          <div key={keys}>
            <dt>
              <kbd>{keys}</kbd>
            </dt>
            <dd>{what}</dd>
          </div>
        ))}
      </dl>
      <p className="quiet">
        Drag from a frame (circle) to a joint (square) to mount a body; from a frame to a frame to close a loop or to
        put a spring between.
      </p>
    </Window>
  );
}
