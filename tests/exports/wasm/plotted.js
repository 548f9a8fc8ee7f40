() => {
  const sheet = document.getElementById("plot"), { width, height } = sheet;
  const data = sheet.getContext("2d").getImageData(0, 0, width, height).data;
  const colour = (name) => {
    const label = [...document.querySelectorAll("#signals label")].find((x) => x.textContent.startsWith(name));
    return label.dataset.colour.match(/[0-9a-f]{2}/g).map((x) => parseInt(x, 16));
  };
  const count = (name) => {
    const wanted = colour(name);
    let n = 0;
    for (let k = 0; k < data.length; k += 4)
      n += wanted.every((x, i) => Math.abs(x - data[k + i]) < 12) && data[k + 3] > 200;
    return n;
  };
  return { speed: count("speed of q1"), angle: count("q1") };
}
