// Pictures of pages for the guide: node run.mjs FOLDER BUNDLE screenshots.mjs with BUILD_PAGE, ATLAS_PAGE and PICTURES (a
// folder) in the environment. Writes page_model.jpg, page_slices.jpg and page_atlas.jpg.
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './chromium.mjs';

const browser = await openBrowser();

async function open(path) {
  const page = await browser.newPage();
  await page.setViewport({ width: 1120, height: 1000 });
  await page.goto(pathToFileURL(path).href);
  await page.waitForFunction(() => document.title.endsWith('rendered'), { timeout: 60000 });
  return page;
}

async function set(page, selector, value) {
  await page.$eval(
    selector,
    (control, text) => {
      control.value = text;
      for (const type of ['input', 'change']) {
        control.dispatchEvent(new Event(type, { bubbles: true }));
      }
    },
    String(value)
  );
}

async function shoot(page, selector, name) {
  await new Promise((resolve) => setTimeout(resolve, 1000));
  const node = await page.$(selector);
  await node.screenshot({ path: join(process.env.PICTURES, name), type: 'jpeg', quality: 82 });
}

try {
  const build = await open(process.env.BUILD_PAGE);
  await set(build, '#cut-orientation', 'coronal');
  await build.evaluate(() => window.bonetkPage.viewer.scene.turn(28, 14));
  await shoot(build, '#viewer', 'page_model.jpg');
  await shoot(build, '#slices', 'page_slices.jpg');
  const atlas = await open(process.env.ATLAS_PAGE);
  await set(atlas, '#mode-shape-1', 2);
  await shoot(atlas, '#atlas', 'page_atlas.jpg');
} finally {
  await browser.close();
}
