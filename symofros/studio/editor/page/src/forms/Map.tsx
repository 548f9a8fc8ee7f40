import { useState } from "react";

import type { Json, JsonMap, Path } from "../api/types";
import { keyOf } from "../model/changes";
import { at, isMap, replaced } from "../model/paths";
import { IconButton } from "../shell/IconButton";
import { useForm } from "./context";
import { FieldControl } from "./Field";
import { start } from "./OneOf";
import { field } from "./schema";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  label: string;
  entry: JsonMap;
  keys: string[] | null;
}

/** A field for the name of a new entry. */
function Adder({
  label,
  keys,
  taken,
  add,
}: {
  label: string;
  keys: string[] | null;
  taken: string[];
  add(name: string): void;
}) {
  const [name, setName] = useState("");
  const usable = name.trim() !== "" && !taken.includes(name.trim());
  const commit = (): void => {
    if (usable) add(name.trim());
    setName("");
  };
  const free = keys?.filter((key) => !taken.includes(key));
  return (
    <div className="adders">
      {free === undefined ? (
        <input
          className="name"
          value={name}
          placeholder="name"
          aria-label={`Name of a new entry of ${label.toLowerCase()}`}
          spellCheck={false}
          onChange={(event) => setName(event.target.value)}
          onKeyDown={(event) => {
            if (event.key !== "Enter") return;
            event.preventDefault();
            commit();
          }}
        />
      ) : (
        <select
          value={name}
          aria-label={`New entry of ${label.toLowerCase()}`}
          onChange={(event) => setName(event.target.value)}
        >
          <option value="">-</option>
          {free.map((key) => (
            <option key={key}>{key}</option>
          ))}
        </select>
      )}
      <button type="button" className="small" disabled={!usable} onClick={commit}>
        Add
      </button>
    </div>
  );
}

/** An entry's name; that of a frame that the file has can be changed, and what refers to it follows. */
function EntryName({ label, name, path }: { label: string; name: string; path: Path }) {
  const { data, renames, rename, hint } = useForm();
  if (path.at(-2) !== "frames" || at(data, path) === undefined) return <span className="item-name">{name}</span>;
  return (
    <input
      className="item-name"
      value={renames[keyOf(path)] ?? name}
      aria-label={`Name of ${label.toLowerCase()} ${name}`}
      spellCheck={false}
      onFocus={() => hint("Renaming it changes all that refers to it.")}
      onChange={(event) => rename(path, event.target.value)}
    />
  );
}

/** Entries with names. */
export function MapField({ value, onChange, path, label, entry, keys }: Props) {
  const { root } = useForm();
  const map = isMap(value) ? value : {};
  const described = { ...field(root, entry), optional: false };
  return (
    <div className="map" role="group" aria-label={label}>
      {Object.entries(map).map(([name, each]) => (
        <div key={name} className="item">
          <EntryName label={label} name={name} path={[...path, name]} />
          <FieldControl
            name=""
            field={described}
            value={each}
            onChange={(next) => onChange(replaced(map, name, next ?? {}))}
            path={[...path, name]}
            label={`${label} ${name}`}
            siblings={undefined}
          />
          <div className="item-tools">
            <IconButton
              glyph="close"
              label={`Remove ${name}`}
              onClick={() => onChange(replaced(map, name, undefined))}
            />
          </div>
        </div>
      ))}
      <Adder
        label={label}
        keys={keys}
        taken={Object.keys(map)}
        add={(name) => onChange({ ...map, [name]: start(root, entry) })}
      />
    </div>
  );
}
