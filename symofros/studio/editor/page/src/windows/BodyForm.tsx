import { useState } from "react";

import type { Json, Path } from "../api/types";
import { useForm } from "../forms/context";
import { FieldControl } from "../forms/Field";
import { RecordField } from "../forms/Record";
import { definition, field, type Shape } from "../forms/schema";
import { forceEntries, motionEntries } from "../model/joints";
import { isMap, mapAt, replaced } from "../model/paths";
import { type Tab, Tabs } from "../shell/Tabs";
import { BeamForm } from "./BeamForm";
import { MatterForm } from "./MatterForm";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
}

type Page = "joint" | "matter" | "frames" | "forces";

function useRecord(name: string): Shape & { kind: "record" } {
  const { root } = useForm();
  const { shape } = definition(root, name);
  if (shape.kind !== "record") throw new Error(`${name} is no record of the schema`);
  return shape;
}

function JointPage({ value, onChange, path }: Props) {
  const shape = useRecord("JointEntry");
  const joint = isMap(value) ? value["joint"] : undefined;
  const set = (next: Json | undefined): void => onChange(replaced(value, "joint", next));
  if (!isMap(joint)) {
    return (
      <p>
        Without a joint this body is the base: it does not move.{" "}
        <button type="button" className="small" onClick={() => set({ kind: "revolute" })}>
          Add joint
        </button>
      </p>
    );
  }
  return (
    <RecordField shape={shape} value={joint} onChange={set} path={[...path, "joint"]} only={motionEntries(joint)} />
  );
}

function ForcesPage({ value, onChange, path }: Props) {
  const joint = useRecord("JointEntry");
  const body = useRecord("BodyEntry");
  const has = isMap(value) && isMap(value["joint"]);
  const isBeam = isMap(value) && isMap(value["beam"]);
  const set = (next: Json | undefined): void => onChange(replaced(value, "joint", next));
  return (
    <>
      {has ? <h3>On the joint</h3> : null}
      {has ? (
        <RecordField
          shape={joint}
          value={mapAt(value, ["joint"])}
          onChange={set}
          path={[...path, "joint"]}
          only={forceEntries}
        />
      ) : null}
      {isBeam ? null : (
        <>
          <h3>On the body</h3>
          <RecordField shape={body} value={value} onChange={onChange} path={path} only={["loads"]} />
        </>
      )}
    </>
  );
}

function FramesPage({ value, onChange, path }: Props) {
  const { root } = useForm();
  const described = field(root, mapAt(root, ["$defs", "BodyEntry", "properties", "frames"]));
  const frames = isMap(value) ? value["frames"] : undefined;
  return (
    <FieldControl
      name="frames"
      field={described}
      value={frames}
      onChange={(next) => onChange(replaced(value, "frames", next))}
      path={[...path, "frames"]}
      label="Frames"
      siblings={value}
    />
  );
}

/** The page that shows an entry of a body; none for the body as a whole. */
function pageOf([key, inner]: Path): Page | null {
  if (key === "joint") return forceEntries.includes(String(inner)) ? "forces" : "joint";
  if (key === "inertia" || key === "solid" || key === "beam" || key === "waive") return "matter";
  return key === "frames" ? "frames" : key === "loads" ? "forces" : null;
}

/** A body: its joint, its inertia or beam, its frames, the forces. */
export function BodyForm({ value, onChange, path, entry }: Props & { entry: Path }) {
  const isBeam = isMap(value) && isMap(value["beam"]);
  const body = useRecord("BodyEntry");
  const { hint } = useForm();
  const [page, setPage] = useState<Page>(pageOf(entry) ?? (isBeam ? "matter" : "joint"));
  const turn = (to: Page): void => {
    hint(""); // It was of a field of the page that is left.
    setPage(to);
  };
  const tabs: Tab<Page>[] = [
    { key: "joint", title: "Joint" },
    { key: "matter", title: isBeam ? "Beam" : "Inertia" },
    { key: "frames", title: "Frames" },
    { key: "forces", title: "Forces" },
  ];
  const props = { value, onChange, path };
  return (
    <Tabs<Page> tabs={tabs} current={page} onChange={turn} label="Properties of the body">
      {page === "joint" ? <JointPage {...props} /> : null}
      {page === "matter" && isBeam ? (
        <>
          <BeamForm
            value={mapAt(value, ["beam"])}
            onChange={(next) => onChange(replaced(value, "beam", next))}
            path={[...path, "beam"]}
          />
          <RecordField shape={body} value={value} onChange={onChange} path={path} only={["waive"]} />
        </>
      ) : null}
      {page === "matter" && !isBeam ? <MatterForm value={value} onChange={onChange} path={path} shape={body} /> : null}
      {page === "frames" ? <FramesPage {...props} /> : null}
      {page === "forces" ? <ForcesPage {...props} /> : null}
    </Tabs>
  );
}
