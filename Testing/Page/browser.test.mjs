// The report page in headless Chromium, opened from disk. Run by run.mjs, which says where puppeteer and the bundle
// are.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test, { after, before } from 'node:test';
import { pathToFileURL } from 'node:url';
import { densityColour } from '../../Modules/Report/page/src/colours.js';
import { openBrowser } from './chromium.mjs';
import { atlasData, boneShape, densityOfRegion, modelData, slicesData, writePage } from './fixture.mjs';

const bundle = process.env.BONETK_PAGE_BUNDLE;
const folder = mkdtempSync(join(tmpdir(), 'bonetk-page-'));
let browser;

before(async () => {
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

/** What went wrong on a page, and what it asked of other places than itself. */
function listen(page) {
  const log = [];
  page.on('console', (message) => ['error', 'warn'].includes(message.type()) && log.push(message.text()));
  page.on('pageerror', (error) => log.push(error.message));
  page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || log.push(`asks for ${request.url()}`));
  return log;
}

/** Opens a page of these data, and waits until it is rendered. */
async function openPage(data, { scheme = 'light', width = 1200, height = 900, packed = bundle, edit } = {}) {
  const path = join(folder, `${Math.random().toString(36).slice(2)}.html`);
  writePage(path, data, packed, edit);
  const page = await browser.newPage();
  const log = listen(page);
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: scheme }]);
  await page.goto(pathToFileURL(path).href);
  return { page, log };
}

async function rendered(data, options) {
  const opened = await openPage(data, options);
  await opened.page.waitForFunction(() => document.title.endsWith('rendered'), { timeout: 30000 });
  await settled(opened.page);
  return opened;
}

/** Waits until what was asked for is drawn. */
async function settled(page) {
  await page.evaluate(
    () =>
      new Promise((resolve) => {
        requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(resolve)));
      })
  );
}

/** The pixels of a canvas: width, height, and red, green, blue, alpha of each. */
async function pixels(page, selector) {
  await settled(page);
  const { width, height, data } = await page.$eval(selector, (canvas) => {
    const copy = document.createElement('canvas');
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const image = context.getImageData(0, 0, copy.width, copy.height);
    let text = '';
    for (let i = 0; i < image.data.length; i += 8192) {
      text += String.fromCharCode(...image.data.subarray(i, i + 8192));
    }
    return { width: image.width, height: image.height, data: btoa(text) };
  });
  return { width, height, data: Buffer.from(data, 'base64') };
}

/** The share of pixels that differ. */
function difference(before, after) {
  assert.deepEqual([before.width, before.height], [after.width, after.height]);
  let count = 0;
  for (let i = 0; i < before.data.length; i += 4) {
    count += before.data.compare(after.data, i, i + 4, i, i + 4) !== 0 ? 1 : 0;
  }
  return (4 * count) / before.data.length;
}

async function changes(page, selector, action, least = 0.002) {
  const first = await pixels(page, selector);
  assert.equal(difference(first, await pixels(page, selector)), 0, 'the picture changes by itself');
  await action();
  const share = difference(first, await pixels(page, selector));
  assert.ok(share > least, `${(100 * share).toFixed(2)} % of the pixels have changed`);
}

/** Sets a control's value as its user would. */
async function set(page, selector, value, type = 'input') {
  await page.$eval(
    selector,
    (control, text, event) => {
      control.value = text;
      control.dispatchEvent(new Event(event, { bubbles: true }));
    },
    String(value),
    type
  );
  await settled(page);
}

const colourAt = ({ width, data }, [x, y]) => [
  ...data.subarray(4 * (Math.round(y) * width + Math.round(x))).subarray(0, 3)
];
const view3d = '#view3d canvas';

test('the whole page is rendered without errors or requests, and its title says so', async () => {
  const { page, log } = await rendered({ name: 'solid', model: modelData(), slices: slicesData(), atlas: atlasData() });
  assert.equal(await page.title(), 'BoneTK report: solid \u2013 rendered');
  assert.ok(await page.evaluate(() => window.bonetkPage.frameTime > 0));
  for (const id of ['view3d', 'level', 'region-1', 'region-2', 'region-3', 'cut', 'slices', 'slice', 'atlas-view3d']) {
    assert.ok(await page.$(`#${id}`), `no element ${id}`);
  }
  const ids = await page.evaluate(() => [...document.querySelectorAll('[id]')].map(({ id }) => id));
  assert.equal(new Set(ids).size, ids.length, 'an id stands twice');
  assert.deepEqual(log, []);
  await page.close();
});

test('each control changes the 3D picture', async () => {
  const { page, log } = await rendered({ name: 'solid', model: modelData() });
  await changes(page, view3d, () => page.click('#region-1'));
  await page.click('#region-1');
  await changes(page, view3d, () => page.click('#cut-on'));
  const [low, high] = await page.$eval('#cut', (control) => [Number(control.min), Number(control.max)]);
  await changes(page, view3d, () => set(page, '#cut', low + 0.7 * (high - low)));
  await changes(page, view3d, () => page.click('#cut-edges'));
  await changes(page, view3d, () => page.click('#region-2'));
  await changes(page, view3d, () => set(page, '#cut-orientation', 'sagittal', 'change'));
  await changes(page, view3d, () => page.click('#cut-on'));
  await changes(page, view3d, () => page.select('#level', '1'));
  assert.equal(await page.evaluate(() => window.bonetkPage.level), 1);
  await changes(page, view3d, () => set(page, '#opacity-1', 30));
  await changes(page, view3d, () => page.select('#colour', 'region'));
  await changes(page, view3d, () => page.click('#contours-1'), 0.0005);
  await changes(page, view3d, () => page.click('#landmarks'), 0.0005);
  assert.deepEqual(log, []);
  await page.close();
});

test('the cut has the colours of the density where it is projected to, after turns too', async () => {
  const { page } = await rendered({ name: 'solid', model: modelData([[16, 16, 20]]) });
  const range = [-200, 1600];
  await set(page, '#cut-orientation', 'coronal', 'change');
  await set(page, '#cut', 1.5);
  for (const turn of [null, 'ArrowLeft', 'ArrowUp']) {
    if (turn) {
      await page.focus(view3d);
      await page.keyboard.press(turn);
    }
    const picture = await pixels(page, view3d);
    // Inside cells of region 2 and 3, away from edges.
    for (const [region, x] of [
      [2, [10, 1.5, 3]],
      [2, [-9, 1.5, 20]],
      [3, [1, 1.5, 2]],
      [3, [-2, 1.5, -5]]
    ]) {
      const expected = densityColour((densityOfRegion[region](...x) - range[0]) / (range[1] - range[0]));
      const at = await page.evaluate((point) => window.bonetkPage.project(point), x);
      const colour = colourAt(picture, at);
      const error = Math.max(...colour.map((channel, i) => Math.abs(channel - expected[i])));
      assert.ok(error <= 3, `at ${x}, turned by ${turn}: ${colour} is not ${expected}`);
    }
  }
  const { points } = await page.evaluate(() => ({ points: [...window.bonetkPage.cut().points] }));
  assert.ok(points.length > 9000);
  assert.ok(points.every((value, i) => i % 3 !== 1 || Math.abs(value - 1.5) < 1e-9));
  await page.close();
});

/** The share of a narrow range that a colour of the map stands for, and how far it is from the map. */
function shareOf(colour) {
  const steps = 2000;
  let best = [Infinity, NaN];
  for (let i = 0; i <= steps; ++i) {
    const distance = Math.hypot(...densityColour(i / steps).map((channel, c) => channel - colour[c]));
    best = distance < best[0] ? [distance, i / steps] : best;
  }
  return best;
}

for (const [title, counts, degrees] of [
  ['of mixed degrees', [7, 7, 8], { 1: 3, 2: 2, 3: 1 }],
  ['of the highest degree', [7, 7, 8], { 1: 8, 2: 8, 3: 8 }]
]) {
  test(`each pixel of a cut has the density of its own place, ${title}`, async () => {
    const data = { name: 'solid', model: modelData([counts], degrees) };
    const range = [310, 390];
    data.model.range = range;
    const { page, log } = await rendered(data);
    await set(page, '#cut-orientation', 'coronal', 'change');
    await set(page, '#cut', 1.5);
    await page.evaluate(() => window.bonetkPage.lookFrom('anterior'));
    const picture = await pixels(page, view3d);
    const places = [];
    for (let x = -11; x <= 11; x += 0.5) {
      for (let z = -32; z <= 32; z += 0.5) {
        places.push([x, 1.5, z]);
      }
    }
    const projected = await page.evaluate((list) => list.map((place) => window.bonetkPage.project(place)), places);
    const mm = await page.evaluate(() => window.bonetkPage.viewer.scene.millimetresPerPixel());
    const errors = [];
    projected.forEach(([across, down], i) => {
      const pixel = [Math.floor(across), Math.floor(down)];
      // Where the pixel's middle lies: seen from the front, +x is at the right.
      const [x, y, z] = places[i];
      const middle = [x + mm * (pixel[0] + 0.5 - across), y, z - mm * (pixel[1] + 0.5 - down)];
      const expected = densityOfRegion[2](...middle);
      const [distance, share] = shareOf(colourAt(picture, pixel));
      // The other regions' densities are far from this range: their places have the colours of its ends.
      if (distance < 4 && share > 0.02 && share < 0.98 && expected > range[0] + 1 && expected < range[1] - 1) {
        errors.push(Math.abs(range[0] + share * (range[1] - range[0]) - expected));
      }
    });
    const mean = errors.reduce((sum, error) => sum + error, 0) / errors.length;
    const share = errors.filter((error) => error > 1).length / errors.length;
    assert.ok(errors.length > 1000, `${errors.length} places`);
    // Densities are stored in steps of 0.25; at regions' edges colours are mixed.
    assert.ok(mean < 0.3 && share < 0.01, `mean error ${mean} HU, ${100 * share} % above 1 HU`);
    assert.deepEqual(log, []);
    await page.close();
  });
}

test('the front half is clipped away, whichever side the camera stands', async () => {
  const { page } = await rendered({ name: 'solid', model: modelData() });
  await set(page, '#cut-orientation', 'coronal', 'change');
  await set(page, '#cut', 0);
  for (const name of ['anterior', 'posterior']) {
    await page.evaluate((view) => window.bonetkPage.lookFrom(view), name);
    const picture = await pixels(page, view3d);
    const x = [1, 0, 2];
    const expected = densityColour((densityOfRegion[3](...x) + 200) / 1800);
    const colour = colourAt(picture, await page.evaluate((point) => window.bonetkPage.project(point), x));
    assert.ok(Math.max(...colour.map((channel, i) => Math.abs(channel - expected[i]))) <= 3, `${name}: ${colour}`);
  }
  await page.close();
});

test('the first view is anterior: the left at the right, the head up; the presets are as named', async () => {
  const { page } = await rendered({ name: 'solid', model: modelData() });
  const project = (x) => page.evaluate((point) => window.bonetkPage.project(point), x);
  const background = colourAt(await pixels(page, view3d), [5, 5]);
  const isBone = async (x) => {
    const colour = colourAt(await pixels(page, view3d), await project(x));
    return colour.some((channel, i) => Math.abs(channel - background[i]) > 12);
  };
  // The solid has a bump at its left alone, seen from the front and from behind.
  const bump = boneShape(0.95, 0, 0.55);
  assert.ok(await isBone(bump));
  assert.ok(!(await isBone([-bump[0], bump[1], bump[2]])));
  // To the right and upward in the picture, by view.
  const axes = {
    anterior: [
      [1, 0, 0],
      [0, 0, 1]
    ],
    posterior: [
      [-1, 0, 0],
      [0, 0, 1]
    ],
    left: [
      [0, 1, 0],
      [0, 0, 1]
    ],
    right: [
      [0, -1, 0],
      [0, 0, 1]
    ],
    superior: [
      [-1, 0, 0],
      [0, -1, 0]
    ],
    inferior: [
      [1, 0, 0],
      [0, -1, 0]
    ]
  };
  const check = async (name) => {
    const [rightward, upward] = axes[name];
    const centre = await project([0, 0, 0]);
    const right = await project(rightward.map((value) => 10 * value));
    const up = await project(upward.map((value) => 10 * value));
    assert.ok(right[0] > centre[0] + 5 && Math.abs(right[1] - centre[1]) < 0.01, name);
    assert.ok(up[1] < centre[1] - 5 && Math.abs(up[0] - centre[0]) < 0.01, name);
  };
  await check('anterior');
  const buttons = await page.$$('#viewer .buttons button');
  for (const button of buttons) {
    await button.click();
    await check((await button.evaluate((node) => node.textContent)).toLowerCase());
  }
  assert.equal(buttons.length, 6);
  await page.close();
});

test('the scale bar is as long as it says', async () => {
  const { page } = await rendered({ name: 'solid', model: modelData() });
  for (const zoom of ['', '+', '-']) {
    if (zoom) {
      await page.focus(view3d);
      await page.keyboard.press(zoom);
      await settled(page);
    }
    const { width, millimetres } = await page.$eval('#view3d .scale-bar', (bar) => ({
      width: bar.getBoundingClientRect().width,
      millimetres: parseFloat(bar.textContent)
    }));
    const [left, right] = await page.evaluate(
      (mm) => [window.bonetkPage.project([0, 0, 0])[0], window.bonetkPage.project([mm, 0, 0])[0]],
      millimetres
    );
    assert.ok(Math.abs(right - left - width) < 0.5, `${width} pixels for ${millimetres} mm, not ${right - left}`);
  }
  await page.close();
});

test('the wheel scrolls the page, and zooms only once the picture is clicked', async () => {
  const { page } = await rendered({ name: 'solid', model: modelData() });
  const place = await page.$eval(view3d, (canvas) => {
    canvas.scrollIntoView({ block: 'end' });
    const box = canvas.getBoundingClientRect();
    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  });
  const zoom = () => page.evaluate(() => window.bonetkPage.viewer.scene.millimetresPerPixel());
  const scrolled = () => page.evaluate(() => window.scrollY);
  await page.mouse.move(place.x, place.y);
  const [zoomBefore, scrollBefore] = [await zoom(), await scrolled()];
  await page.mouse.wheel({ deltaY: 100 });
  await page.waitForFunction((y) => window.scrollY !== y, { timeout: 5000 }, scrollBefore);
  assert.equal(await zoom(), zoomBefore);
  await page.mouse.click(place.x, place.y - 100);
  const scrollThen = await scrolled();
  await page.mouse.wheel({ deltaY: -100 });
  await page.waitForFunction(
    (mm) => window.bonetkPage.viewer.scene.millimetresPerPixel() < 0.95 * mm,
    { timeout: 5000 },
    zoomBefore
  );
  assert.equal(await scrolled(), scrollThen);
  await page.keyboard.press('Escape');
  assert.equal(await page.evaluate(() => document.activeElement === document.body), true);
  await page.close();
});

test('dragging turns the model, with Shift moves it', async () => {
  const { page } = await rendered({ name: 'solid', model: modelData() });
  const box = await (await page.$(view3d)).boundingBox();
  const drag = async () => {
    await page.mouse.move(box.x + 200, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x + 260, box.y + 230, { steps: 3 });
    await page.mouse.up();
  };
  const project = (x) => page.evaluate((point) => window.bonetkPage.project(point), x);
  const front = [
    [0, -14, 0],
    [0, 14, 0]
  ];
  const before = await Promise.all(front.map(project));
  await page.keyboard.down('Shift');
  await drag();
  await page.keyboard.up('Shift');
  const moved = await Promise.all(front.map(project));
  moved.forEach((place, i) => {
    assert.ok(Math.abs(place[0] - before[i][0] - 60) < 0.5 && Math.abs(place[1] - before[i][1] - 30) < 0.5, `${place}`);
  });
  await drag();
  const turned = await Promise.all(front.map(project));
  // What lies in front follows the pointer, what lies behind goes the other way.
  assert.ok(turned[0][0] > moved[0][0] + 5 && turned[1][0] < moved[1][0] - 5, `${moved} became ${turned}`);
  assert.ok(turned[0][1] > moved[0][1] + 2 && turned[1][1] < moved[1][1] - 2, `${moved} became ${turned}`);
  await page.close();
});

test('a model without density is coloured by its regions', async () => {
  const model = modelData([[7, 7, 8]]);
  delete model.levels[0].degrees;
  delete model.levels[0].coefficients;
  const { page, log } = await rendered({ name: 'mesh', model });
  assert.equal(await page.$eval('#colour', (control) => control.value), 'region');
  await changes(page, view3d, () => page.click('#region-1'));
  assert.deepEqual(log, []);
  await page.close();
});

test('slices: slider, keys and window change the picture, the title names the slice, contours lie at the rim', async () => {
  const data = slicesData();
  const { page, log } = await rendered({ name: 'solid', slices: data });
  const canvas = '#slices .picture canvas';
  const title = () => page.$eval('#slices .picture-title', (node) => node.textContent);
  await changes(page, canvas, () => set(page, '#slice', 1));
  assert.equal(await title(), data.titles[1]);
  await page.focus(canvas);
  await changes(page, canvas, () => page.keyboard.press('ArrowRight'));
  assert.equal(await title(), data.titles[2]);
  assert.equal(await page.$eval('#slice', (control) => control.value), '2');
  await changes(page, canvas, () => set(page, '#window-width', 600));
  await changes(page, canvas, () => set(page, '#window-level', 100));
  const picture = await pixels(page, canvas);
  const scale = picture.width / data.columns;
  const { points } = data.contours[2][0];
  for (const i of [0, 22, 50, 84]) {
    const [red, green, blue] = colourAt(picture, [
      (points[i] + 0.5) * scale - 0.5,
      (points[i + 1] + 0.5) * scale - 0.5
    ]);
    assert.ok(red > 1.5 * green && red > 1.5 * blue, `contour at point ${i / 2}: ${[red, green, blue]}`);
  }
  await changes(page, canvas, () => page.click('#slice-contours'));
  const sides = await page.$$eval('#slices .letter', (nodes) =>
    nodes.map((node) => {
      const box = node.getBoundingClientRect();
      const frame = node.parentElement.getBoundingClientRect();
      return [
        node.textContent,
        (box.x + box.width / 2 - frame.x) / frame.width,
        (box.y + box.height / 2 - frame.y) / frame.height
      ];
    })
  );
  const centres = { R: [0, 0.5], L: [1, 0.5], A: [0.5, 0], P: [0.5, 1] };
  for (const [letter, x, y] of sides) {
    assert.ok(Math.hypot(x - centres[letter][0], y - centres[letter][1]) < 0.1, `${letter} stands at ${x}, ${y}`);
  }
  assert.deepEqual(log, []);
  await page.close();
});

test('slices in a JPEG have the grey values of their tiles', async () => {
  // Five slices of 30 x 20 in tiles of 32 x 24, two in a row: a slope in each, which differs in direction and height.
  const [columns, rows, count, across, tile] = [30, 20, 5, 2, [32, 24]];
  const slope = (k, column, row) => 20 + 30 * k + (k % 2 ? 3 * column : 4 * row);
  const blank = await browser.newPage();
  const jpeg = await blank.evaluate(
    (size, greys) => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = size;
      const context = canvas.getContext('2d');
      const image = context.createImageData(...size);
      greys.forEach((grey, i) => image.data.set([grey, grey, grey, 255], 4 * i));
      context.putImageData(image, 0, 0);
      return canvas.toDataURL('image/jpeg', 1).split(',')[1];
    },
    [across * tile[0], 3 * tile[1]],
    Array.from({ length: 3 * tile[1] * across * tile[0] }, (_, i) => {
      const [x, y] = [i % (across * tile[0]), Math.floor(i / (across * tile[0]))];
      const k = Math.floor(y / tile[1]) * across + Math.floor(x / tile[0]);
      return slope(k, x % tile[0], y % tile[1]);
    })
  );
  await blank.close();
  const data = slicesData({ columns, rows, count });
  data.values = { jpeg, across, tile, step: 5, offset: -100 };
  const { page, log } = await rendered({ name: 'solid', slices: data });
  const values = await page.evaluate(() => [...window.bonetkPage.slices.values]);
  assert.equal(values.length, columns * rows * count);
  values.forEach((value, i) => {
    const [k, row, column] = [Math.floor(i / (columns * rows)), Math.floor(i / columns) % rows, i % columns];
    const expected = -100 + 5 * slope(k, column, row);
    assert.ok(Math.abs(value - expected) <= 10, `slice ${k}, column ${column}, row ${row}: ${value}, not ${expected}`);
  });
  assert.deepEqual(log, []);
  await page.close();
});

test('atlas: modes change the model and its radiograph, reset brings both back, animation moves them', async () => {
  const { page, log } = await rendered({ name: 'atlas', atlas: atlasData() });
  const radiograph = '.radiograph canvas';
  const rest = async () => {
    await page.waitForFunction((columns) => document.querySelector('.radiograph canvas').width === columns, {}, 96);
    await settled(page);
  };
  await rest();
  const first = [await pixels(page, view3d), await pixels(page, radiograph)];
  const moved = async (mode, value) => {
    await set(page, `#mode-${mode}`, value);
    await new Promise((resolve) => setTimeout(resolve, 400));
    await rest();
    return [difference(first[0], await pixels(page, view3d)), difference(first[1], await pixels(page, radiograph))];
  };
  const stretched = await moved('shape-1', 2);
  assert.ok(stretched[0] > 0.01 && stretched[1] > 0.01, `${stretched}`);
  await page.click('#atlas-reset');
  assert.deepEqual(await moved('shape-1', 0), [0, 0]);
  const denser = await moved('density-1', 2.5);
  assert.ok(denser[0] > 0.01 && denser[1] > 0.01, `${denser}`);
  await page.click('#atlas-reset');
  await page.click('#atlas-animate');
  await page.waitForFunction(() => Number(document.getElementById('mode-shape-1').value) > 0.5, { timeout: 10000 });
  await page.click('#atlas-animate');
  assert.match(await page.$eval('label[for=mode-shape-1]', (node) => node.textContent), /^shape 1, 43 %$/);
  assert.deepEqual(log, []);
  await page.close();
});

test('each control has a name for screen readers', async () => {
  const { page } = await rendered({
    name: 'solid',
    model: modelData([[4, 4, 5]]),
    slices: slicesData(),
    atlas: atlasData([4, 4, 5])
  });
  const roles = ['button', 'checkbox', 'combobox', 'slider', 'spinbutton', 'image', 'link', 'textbox'];
  const found = [];
  const visit = (node) => {
    if (roles.includes(node.role)) {
      found.push(node.role);
      assert.ok(node.name?.trim(), `a ${node.role} has no name`);
    }
    (node.children ?? []).forEach(visit);
  };
  visit(await page.accessibility.snapshot({ interestingOnly: false }));
  const count = await page.$$eval(
    'button, input, select',
    (nodes) => nodes.filter((node) => node.checkVisibility()).length
  );
  assert.ok(
    found.filter((role) => role !== 'link' && role !== 'image').length >= count,
    `${found.length} of ${count} controls`
  );
  assert.equal(await page.$eval('output[for=cut]', (node) => node.getAttribute('aria-live')), 'polite');
  assert.match(await page.$eval('#cut', (node) => node.getAttribute('aria-valuetext')), /^z = .*mm$/);
  await page.close();
});

test('dark and light have their backgrounds, print is light without controls, narrow pages do not scroll sideways', async () => {
  const data = { name: 'solid', model: modelData([[4, 4, 5]]), slices: slicesData(), atlas: atlasData([4, 4, 5]) };
  const corner = async (page) => colourAt(await pixels(page, view3d), [3, 3]);
  const { page, log } = await rendered(data, { scheme: 'dark' });
  assert.ok(Math.max(...(await corner(page))) < 80);
  await page.emulateMediaType('print');
  await settled(page);
  assert.deepEqual(await corner(page), [255, 255, 255]);
  assert.equal(await page.$eval('.controls', (node) => getComputedStyle(node).display), 'none');
  await page.emulateMediaType('screen');
  await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: 'dark' }]);
  await settled(page);
  assert.ok(Math.max(...(await corner(page))) < 80);
  await page.evaluate(() => window.dispatchEvent(new Event('beforeprint')));
  assert.deepEqual(colourAt(await pixels(page, '#view3d .printed'), [3, 3]), [255, 255, 255]);
  await page.evaluate(() => window.dispatchEvent(new Event('afterprint')));
  assert.equal(await page.$('.printed'), null);
  await page.setViewport({ width: 390, height: 800 });
  await settled(page);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
  assert.deepEqual(log, []);
  await page.close();
});

test('a page without a bundle, with a damaged bundle or with damaged data says so and stays readable', async () => {
  const data = { name: 'solid', slices: slicesData(), model: modelData([[3, 3, 3]]) };
  const notice = async (page, id) => {
    await page.waitForFunction((name) => document.getElementById(name).textContent !== '', { timeout: 10000 }, id);
    return page.$eval(`#${id}`, (node) => node.textContent);
  };
  const empty = await openPage(data, { packed: null });
  assert.match(await notice(empty.page, 'viewer'), /built without npm/);
  const damaged = await openPage(data, {
    edit: (html) => html.replace('id="bonetk-bundle">H4s', 'id="bonetk-bundle">AAA')
  });
  assert.match(await notice(damaged.page, 'viewer'), /interactive views need/);
  data.model.levels[0].points.length += 1;
  const wrong = await rendered(data);
  assert.match(await notice(wrong.page, 'viewer'), /The page's data is damaged/);
  assert.ok(await wrong.page.$('#slices canvas'));
  await Promise.all([empty, damaged, wrong].map(({ page }) => page.close()));
});

test('the bundle holds the licences of its parts', () => {
  const script = readFileSync(join(bundle, 'bundle.js'), 'utf8');
  assert.match(script, /@kitware\/vtk\.js [\d.]+, BSD-3-Clause/);
  assert.match(script, /Copyright \(c\) 2016, Kitware Inc\./);
});
