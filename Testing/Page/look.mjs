// What a page shows, as numbers: node look.mjs REQUEST.json RESULT.json. The request holds `page` (its path) and, as it
// likes, `points` (LPS mm by name, projected in each view), `slices` (numbers in the CT: titles and pixels of those nearest), `cuts` (each with
// level, orientation, position, view) and `change` (a control, its value, and the canvases to compare).
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './chromium.mjs';

const request = JSON.parse(readFileSync(process.argv[2], 'utf8'));
const result = { log: [] };

/** In the page: base64 of the numbers of a typed array, or of a canvas' pixels (red, green, blue, alpha). */
function addHelpers() {
  window.look = {
    base64(array) {
      const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
      let text = '';
      for (let i = 0; i < bytes.length; i += 8192) {
        text += String.fromCharCode(...bytes.subarray(i, i + 8192));
      }
      return btoa(text);
    },
    picture(selector) {
      const canvas = document.querySelector(selector);
      const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
      copy.drawImage(canvas, 0, 0);
      const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
      return { columns: canvas.width, rows: canvas.height, data: this.base64(data) };
    },
    frames: (count) =>
      new Promise((resolve) => {
        const next = (left) => (left > 0 ? requestAnimationFrame(() => next(left - 1)) : resolve());
        next(count);
      }),
    set(selector, value) {
      const control = document.querySelector(selector);
      control.value = value;
      control.dispatchEvent(new Event('input', { bubbles: true }));
      control.dispatchEvent(new Event('change', { bubbles: true }));
      return this.frames(3);
    }
  };
}

/** The letters that stand at the sides of the slices' picture, by where they are seen. */
function seenLetters() {
  const seen = {};
  for (const node of document.querySelectorAll('#slices .letter')) {
    const frame = node.parentElement.getBoundingClientRect();
    const box = node.getBoundingClientRect();
    const x = (box.x + box.width / 2 - frame.x) / frame.width - 0.5;
    const y = (box.y + box.height / 2 - frame.y) / frame.height - 0.5;
    seen[Math.abs(x) > Math.abs(y) ? (x < 0 ? 'left' : 'right') : y < 0 ? 'top' : 'bottom'] = node.textContent;
  }
  return seen;
}

/** Title and pixels of the slices nearest to those with these numbers in the CT. */
async function lookAtSlices(numbers) {
  document.getElementById('slice-contours').click();
  const { data } = window.bonetkPage.slices;
  const numberOf = (title) => Number(title.match(/^CT slice (\d+),/)?.[1] ?? NaN);
  const slices = [];
  for (const number of numbers) {
    const distances = data.titles.map((title) => Math.abs(numberOf(title) - number));
    await window.look.set('#slice', distances.indexOf(Math.min(...distances)));
    const title = document.querySelector('#slices .picture-title').textContent;
    slices.push({ title, number: numberOf(title), ...window.look.picture('#slices .picture canvas') });
  }
  return { slices, millimetres: data.pixel * data.columns };
}

async function lookAtCut({ level, orientation, position, view }) {
  const { bonetkPage, look } = window;
  if (bonetkPage.level !== level) {
    const before = bonetkPage.viewer.mesh;
    await look.set('#level', level);
    while (bonetkPage.viewer.mesh === before) {
      await look.frames(2);
    }
  }
  await look.set('#cut-orientation', orientation);
  await look.set('#cut', position);
  if (view) {
    bonetkPage.lookFrom(view);
    bonetkPage.viewer.fit();
    await look.frames(3);
  }
  const begin = performance.now();
  bonetkPage.viewer.computeCut();
  const milliseconds = performance.now() - begin;
  const cut = bonetkPage.cut();
  return {
    milliseconds,
    cells: bonetkPage.viewer.mesh.cellCount,
    points: look.base64(cut.points),
    degree: cut.degree,
    coefficients: look.base64(cut.coefficients),
    regions: look.base64(cut.regions),
    picture: view ? look.picture('#view3d canvas') : null
  };
}

const browser = await openBrowser();
try {
  const page = await browser.newPage();
  const listen = (message) => result.log.push(message);
  page.on('console', (message) => ['error', 'warn'].includes(message.type()) && listen(message.text()));
  page.on('pageerror', (error) => listen(error.message));
  page.on('request', (asked) => /^(file|data|blob):/.test(asked.url()) || listen(`asks for ${asked.url()}`));
  await page.setViewport({ width: 1200, height: 900 });
  await page.evaluateOnNewDocument(addHelpers);
  await page.goto(pathToFileURL(request.page).href);
  await page.waitForFunction(() => document.title.endsWith('rendered'), { timeout: 30000 });
  result.title = await page.title();
  result.frameTime = await page.evaluate(() => window.bonetkPage?.frameTime ?? null);
  await page.evaluate(() => window.look.frames(3));
  if (request.points) {
    result.views = await page.evaluate((points) => {
      const { bonetkPage } = window;
      const project = () =>
        Object.fromEntries(Object.entries(points).map(([name, x]) => [name, bonetkPage.project(x)]));
      const names = ['anterior', 'posterior', 'left', 'right', 'superior', 'inferior'];
      return Object.fromEntries(
        names.map((name) => {
          bonetkPage.lookFrom(name);
          return [name, project()];
        })
      );
    }, request.points);
  }
  if (request.slices) {
    result.letters = await page.evaluate(seenLetters);
    Object.assign(result, await page.evaluate(lookAtSlices, request.slices));
  }
  result.cuts = [];
  for (const cut of request.cuts ?? []) {
    result.cuts.push(await page.evaluate(lookAtCut, cut));
  }
  if (request.change) {
    const { control, value, canvases } = request.change;
    const pictures = () => page.evaluate((list) => list.map((selector) => window.look.picture(selector)), canvases);
    const wait = () => new Promise((resolve) => setTimeout(resolve, 1500));
    await wait();
    result.before = await pictures();
    await page.evaluate((selector, text) => window.look.set(selector, text), control, value);
    await wait();
    result.after = await pictures();
  }
} finally {
  await browser.close();
}
writeFileSync(process.argv[3], JSON.stringify(result));
