import { describe, expect, it } from "vitest";

import type { JsonMap } from "../src/api/types";
import { blockInsertion, extractBlocks } from "../src/model/diagram_clipboard";

const DATA: JsonMap = {
  models: { arm: { file: "arm.yaml" }, other: { file: "other.yaml" } },
  blocks: {
    where: { kind: "constant", value: 1 },
    pd: { kind: "joint_pd", kp: 3, inputs: { q_desired: "where", q: "plant.q", v: "plant.v" } },
    plant: { kind: "forward_dynamics", model: "arm", inputs: { u: "pd" } },
  },
  parts: { law: { file: "law.yaml", inputs: { q: "plant.q" } } },
  wires: { "law/gain.u": "plant.v", "law/gain.w": "where.y" },
};

const values = (ids: string[], into: JsonMap) =>
  Object.fromEntries(
    blockInsertion(into, extractBlocks(DATA, ids, { [ids[0] ?? ""]: [10, 20] }), 40).edits.map((edit) => [
      edit.path.join(" "),
      "value" in edit ? edit.value : null,
    ]),
  );

describe("copies of blocks", () => {
  it("have names of their own and are wired to each other as the originals were", () => {
    expect(values(["blocks/pd", "blocks/plant"], DATA)).toEqual({
      "blocks pd2": { kind: "joint_pd", kp: 3, inputs: { q: "plant2.q", v: "plant2.v" } },
      "blocks plant2": { kind: "forward_dynamics", model: "arm", inputs: { u: "pd2" } },
    });
  });

  it("bring the models that they name to a diagram that lacks them", () => {
    expect(Object.keys(values(["blocks/plant"], { blocks: {} }))).toEqual(["models arm", "blocks plant"]);
  });

  it("take a copy of a model that was chosen with them", () => {
    const copies = values(["models/arm", "blocks/plant"], DATA);
    expect(copies["models arm2"]).toEqual({ file: "arm.yaml" });
    expect(copies["blocks plant2"]).toMatchObject({ model: "arm2" });
  });

  it("keep wires into parts that come from what was chosen", () => {
    const copies = values(["blocks/plant", "parts/law"], DATA);
    expect(copies["parts law2"]).toEqual({ file: "law.yaml", inputs: { q: "plant2.q" } });
    expect(copies["wires law2/gain.u"]).toBe("plant2.v");
    expect(copies).not.toHaveProperty("wires law2/gain.w");
  });

  it("stand beside the originals", () => {
    const part = extractBlocks(DATA, ["blocks/pd"], { "blocks/pd": [10, 20], "blocks/plant": [0, 0] });
    expect(blockInsertion(DATA, part, 40).places).toEqual({ "blocks/pd2": [50, 60] });
  });
});
