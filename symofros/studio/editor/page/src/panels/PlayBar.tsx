import { brief } from "../model/plot";
import { neighbour } from "../model/runs";
import { pause, play, setTime, SPEEDS } from "../store/playing";
import { update, useStore } from "../store/store";

/** Plays a motion in the 3-D view; its slider, the plots' cursor and the view stand at one time. */
export function PlayBar({ t }: { t: readonly number[] }) {
  const time = useStore((state) => state.time);
  const playing = useStore((state) => state.playing);
  const speed = useStore((state) => state.speed);
  const [start, end] = [t[0] ?? 0, t.at(-1) ?? 0];
  const at = Math.min(Math.max(time ?? start, start), end);
  const step = (by: 1 | -1): void => {
    pause();
    setTime(neighbour(t, at, by));
  };
  return (
    <div className="play-bar" role="group" aria-label="Motion">
      <button type="button" className="small" disabled={end <= start} onClick={playing ? pause : play}>
        {playing ? "Pause" : "Play"}
      </button>
      <button type="button" className="small" aria-label="A step back" disabled={at <= start} onClick={() => step(-1)}>
        ‹
      </button>
      <button type="button" className="small" aria-label="A step on" disabled={at >= end} onClick={() => step(1)}>
        ›
      </button>
      <input
        type="range"
        aria-label="Time [s]"
        min={start}
        max={end}
        step={(end - start) / 1000 || "any"}
        value={at}
        onChange={(event) => {
          pause();
          setTime(Number(event.target.value));
        }}
      />
      <output>{brief(at)} s</output>
      <label>
        Speed{" "}
        <select value={speed} onChange={(event) => update({ speed: Number(event.target.value) })}>
          {SPEEDS.map((each) => (
            <option key={each} value={each}>
              {each}×
            </option>
          ))}
        </select>
      </label>
    </div>
  );
}
