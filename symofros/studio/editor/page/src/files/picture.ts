/** The diagram as a file. */

import type { Document } from "../api/types";
import { drawing } from "../model/drawing";
import { stem } from "../model/names";
import { now } from "../store/store";
import { offer } from "./choose";

const SCALE = 2;

async function rasterised(svg: string): Promise<Blob> {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = window.document.createElement("canvas");
  canvas.width = image.width * SCALE;
  canvas.height = image.height * SCALE;
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve, reject) => {
    canvas.toBlob(
      (blob) => (blob === null ? reject(new Error("the browser can't write PNG")) : resolve(blob)),
      "image/png",
    );
  });
}

export async function savePicture(document: Document, kind: "svg" | "png"): Promise<void> {
  const svg = drawing(document, now().places);
  const blob = kind === "svg" ? new Blob([svg], { type: "image/svg+xml" }) : await rasterised(svg);
  offer(blob, `${stem(document.name)}.${kind}`);
}
