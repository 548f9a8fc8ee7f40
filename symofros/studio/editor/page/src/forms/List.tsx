import type { Json, JsonMap, Path } from "../api/types";
import { replaced } from "../model/paths";
import { IconButton } from "../shell/IconButton";
import { useForm } from "./context";
import { FieldControl } from "./Field";
import { start } from "./OneOf";
import { type Field, field, label as words } from "./schema";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  label: string;
  item: JsonMap;
}

function swapped(list: Json[], place: number): Json[] {
  const next = [...list];
  const [moved] = next.splice(place, 1);
  if (moved !== undefined) next.splice(place - 1, 0, moved);
  return next;
}

/** Buttons that add an item: one a kind, where an item is one of several kinds. */
function Adders({ item, described, add }: { item: JsonMap; described: Field; add(item: Json): void }) {
  const { root } = useForm();
  if (described.shape.kind !== "one of") {
    return (
      <button type="button" className="small" onClick={() => add(start(root, item))}>
        Add
      </button>
    );
  }
  return Object.entries(described.shape.properties).map(([key, schema]) => (
    <button key={key} type="button" className="small" onClick={() => add({ [key]: start(root, schema as JsonMap) })}>
      Add {words(key).toLowerCase()}
    </button>
  ));
}

/** Items in order. */
export function ListField({ value, onChange, path, label, item }: Props) {
  const { root } = useForm();
  const list = Array.isArray(value) ? value : [];
  const described = { ...field(root, item), optional: false };
  const change = (next: Json[]): void => onChange(next.length === 0 ? undefined : next);
  return (
    <div className="list" role="group" aria-label={label}>
      {list.map((each, i) => (
        <div key={i} className="item">
          <FieldControl
            name=""
            field={described}
            value={each}
            onChange={(next) => change(replaced(list, i, next) as Json[])}
            path={[...path, i]}
            label={`${label} ${i + 1}`}
            siblings={undefined}
          />
          <div className="item-tools">
            {i > 0 ? (
              <IconButton
                glyph="up"
                label={`Move ${label.toLowerCase()} ${i + 1} up`}
                onClick={() => change(swapped(list, i))}
              />
            ) : null}
            <IconButton
              glyph="close"
              label={`Remove ${label.toLowerCase()} ${i + 1}`}
              onClick={() => change(replaced(list, i, undefined) as Json[])}
            />
          </div>
        </div>
      ))}
      <div className="adders">
        <Adders item={item} described={described} add={(fresh) => change([...list, fresh])} />
      </div>
    </div>
  );
}
