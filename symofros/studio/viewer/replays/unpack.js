// Restores a recording that `packing` packed, in the form in which viser's page takes it.
const SHARP = Math.cos((40 * Math.PI) / 180);  // Of the angle between triangles that turn so far that their edge is shown.
const unpack = async (text) => {
  const letters = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([letters]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  const data = new Uint8Array(await new Response(stream).arrayBuffer());
  const size = new DataView(data.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(data.subarray(4, 4 + size)));
  let read = 4 + size;
  const take = (count) => data.subarray(read, (read += count));

  // Columns of whole numbers: the lowest bytes of all, then the next ones; signs are folded into the lowest bit.
  const numbers = (count) => {
    const bytes = take(4 * count);
    return Int32Array.from({ length: count }, (_, i) => {
      const folded = bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16) | (bytes[3 * count + i] << 24);
      return (folded >>> 1) ^ -(folded & 1);
    });
  };

  // A mesh: the walk of `connectivity`, then where its corners are, from those that they lie near to.
  const mesh = (array) => {
    const steps = take(array.steps), back = numbers(array.back), count = array.corners;
    const corners = new Uint32Array(3 * array.faces), near = new Int32Array(3 * count);
    const edges = [], open = new Map(), ends = new Map(), starts = new Map();
    let met = 0, step = 0, known = 0, face = 0;
    const key = (start, end) => start * count + end;
    const add = (map, at, what) => { if (map.has(at)) map.get(at).push(what); else map.set(at, [what]); };
    const remove = (list, what) => list.splice(list.indexOf(what), 1);
    const meet = (a, b, c) => { near.set([a, b, c], 3 * met); return met++; };
    const close = (start, end) => {
      remove(ends.get(start), end);
      remove(starts.get(end), start);
      const across = open.get(key(start, end));
      open.delete(key(start, end));
      return across;
    };
    const pass = (start, end, across) => {
      if (open.has(key(start, end))) close(start, end);
      else if (!open.has(key(end, start))) {
        open.set(key(end, start), across);
        edges.push([end, start]);
        add(ends, end, start);
        add(starts, start, end);
      }
    };
    const refer = () => met - 1 - back[known++];
    while (face < array.faces) {
      const first = [0, 1, 2].map(() => (steps[step++] === 1 ? meet(met - 1, met - 1, met - 1) : refer()));
      corners.set(first, 3 * face++);
      for (const i of [0, 1, 2]) pass(first[i], first[(i + 1) % 3], first[(i + 2) % 3]);
      while (edges.length && face < array.faces) {
        const [start, end] = edges.pop();
        if (!open.has(key(start, end))) continue;
        const across = close(start, end), what = steps[step++];
        if (what === 0) continue;
        const third = what === 1 ? meet(start, end, across) : what === 2 ? ends.get(end).at(-1)
          : what === 3 ? starts.get(start).at(-1) : refer();
        corners.set([start, end, third], 3 * face++);
        pass(end, third, start);
        pass(third, start, end);
      }
    }
    while (met < count) meet(met - 1, met - 1, met - 1);
    if (!array.step) return [new Uint8Array(corners.buffer), take(12 * count)];
    const columns = [0, 1, 2].map(() => numbers(count));
    for (const column of columns) {
      for (let i = 1; i < count; i++) column[i] += column[near[3 * i]] + column[near[3 * i + 1]] - column[near[3 * i + 2]];
    }
    return sharp(corners, columns.map((column) => Float32Array.from(column, (number) => array.step * number)));
  };

  // Corners at sharp edges become one for each side, so that these are not smoothed over.
  const sharp = (corners, [x, y, z]) => {
    const normal = [], edges = new Map(), same = corners.map((_, place) => place);
    const after = (place) => (place % 3 === 2 ? place - 2 : place + 1);
    for (let i = 0; i < corners.length; i += 3) {
      const [a, b, c] = corners.subarray(i, i + 3);
      const [p, q, r, u, v, w] = [x, y, z, x, y, z].map((one, k) => one[k < 3 ? b : c] - one[a]);
      const across = [q * w - r * v, r * u - p * w, p * v - q * u], length = Math.hypot(...across) || 1;
      normal.push(across.map((one) => one / length));
    }
    const first = (place) => { while (same[place] !== place) place = same[place] = same[same[place]]; return place; };
    const join = (a, b) => { same[Math.max(first(a), first(b))] = Math.min(first(a), first(b)); };
    corners.forEach((corner, place) => edges.set(corner * x.length + corners[after(place)], place));
    corners.forEach((corner, place) => {
      const met = edges.get(corners[after(place)] * x.length + corner);
      if (met === undefined) return;
      const [a, b] = [place, met].map((one) => normal[Math.floor(one / 3)]);
      if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < SHARP) return;
      join(place, after(met));
      join(after(place), met);
    });
    const numbered = new Map(), points = [];
    const faces = corners.map((corner, place) => {
      const one = first(place);
      if (!numbered.has(one)) {
        numbered.set(one, numbered.size);
        points.push(x[corner], y[corner], z[corner]);
      }
      return numbered.get(one);
    });
    return [new Uint8Array(faces.buffer), new Uint8Array(Float32Array.from(points).buffer)];
  };
  const arrays = header.arrays.flatMap((array) => ("size" in array ? [take(array.size)] : mesh(array)));

  // Poses of each series: what changes of the change from one to the next.
  const series = header.series.map(({ message, of, step, count }) => {
    const columns = (of === "wxyz" ? [0, 1, 2, 3] : [0, 1, 2]).map(() => numbers(count));
    for (const column of columns) for (const _ of [0, 1]) for (let i = 1; i < count; i++) column[i] += column[i - 1];
    let next = 0;
    return () => {
      const k = next++;
      return { ...message, [of]: columns.map((column) => step * column[k]) };
    };
  });
  const messages = header.messages.flatMap(([time, what]) =>
    typeof what === "number" ? header.groups[what].map((k) => [time, series[k]()]) : [[time, what]]);

  // MessagePack, as far as recordings have it.
  const parts = [], sized = (codes, count, part) => {
    const wide = count > 0xffff, head = new DataView(new ArrayBuffer(wide ? 5 : 3));
    head.setUint8(0, codes[wide ? 1 : 0]);
    if (wide) head.setUint32(1, count); else head.setUint16(1, count);
    parts.push(new Uint8Array(head.buffer), ...(part ? [part] : []));
  };
  const write = (value) => {
    if (value === null) parts.push(Uint8Array.of(0xc0));
    else if (typeof value === "boolean") parts.push(Uint8Array.of(value ? 0xc3 : 0xc2));
    else if (typeof value === "number") {
      const head = new DataView(new ArrayBuffer(9)), whole = Number.isInteger(value) && Math.abs(value) < 2 ** 31;
      head.setUint8(0, whole ? 0xd2 : 0xcb);
      if (whole) head.setInt32(1, value); else head.setFloat64(1, value);
      parts.push(new Uint8Array(head.buffer, 0, whole ? 5 : 9));
    } else if (typeof value === "string") {
      const bytes = new TextEncoder().encode(value);
      sized([0xda, 0xdb], bytes.length, bytes);
    } else if (Array.isArray(value)) {
      sized([0xdc, 0xdd], value.length);
      value.forEach(write);
    } else {
      const entries = Object.entries(value);
      sized([0xde, 0xdf], entries.length);
      entries.flat().forEach(write);
    }
  };
  write({ durationSeconds: header.duration, messages, viserVersion: header.version,
    binaryBufferLengths: arrays.map((array) => array.length) });
  const count = parts.reduce((sum, part) => sum + part.length, 0), length = new Uint8Array(8);
  new DataView(length.buffer).setUint32(0, count, true);
  const whole = [length, ...parts];
  let end = 8 + count;
  for (const array of arrays) {
    const gap = -end & 7;
    whole.push(new Uint8Array(gap), array);
    end += gap + array.length;
  }
  const inner = new Uint8Array(await new Blob(whole).arrayBuffer());

  // A frame of zstd whose blocks are stored as they are, behind its length.
  const block = 1 << 17, frame = [new Uint8Array(8), Uint8Array.of(0x28, 0xb5, 0x2f, 0xfd, 0xa0), new Uint8Array(4)];
  new DataView(frame[0].buffer).setUint32(0, inner.length, true);
  new DataView(frame[2].buffer).setUint32(0, inner.length, true);
  for (let i = 0; i < inner.length; i += block) {
    const part = inner.subarray(i, i + block), head = (part.length << 3) | (i + block >= inner.length ? 1 : 0);
    frame.push(Uint8Array.of(head, head >> 8, head >> 16), part);
  }
  const bytes = new Uint8Array(await new Blob(frame).arrayBuffer()), coded = [], most = 3 * 8192;
  for (let i = 0; i < bytes.length; i += most) coded.push(btoa(String.fromCharCode(...bytes.subarray(i, i + most))));
  return coded.join("");
};

unpack("/*packed*/").then((recording) => {
  window.__VISER_EMBED_DATA__ = recording;
  const held = document.getElementById("held"), program = document.createElement("script");
  Object.assign(program.dataset, held.dataset);
  program.textContent = held.textContent;
  held.remove();
  document.head.append(program);
});
