// How long a page of 34,000 cells takes to its first frame, median of five, and the sizes of bundle and page. Run by
// hand: node run.mjs BUILD/Testing/Page BUILD/Modules/Report/page first_frame.mjs. Exits 1 above 3 s, 900 kB, or 300 kB
// packed.
import { mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { openBrowser } from './chromium.mjs';
import { modelData, writePage } from './fixture.mjs';

const bundle = process.env.BONETK_PAGE_BUNDLE;
const script = statSync(join(bundle, 'bundle.js')).size;
const packed = Buffer.from(readFileSync(join(bundle, 'bundle.txt'), 'utf8'), 'base64').length;
const folder = mkdtempSync(join(tmpdir(), 'bonetk-page-'));
const path = join(folder, 'page.html');
writePage(
  path,
  {
    name: '34,680 cells',
    model: modelData([
      [17, 17, 20],
      [8, 8, 10]
    ])
  },
  bundle
);

const times = [];
for (let run = 0; run < 5; ++run) {
  const browser = await openBrowser();
  const page = await browser.newPage();
  await page.goto(pathToFileURL(path).href);
  await page.waitForFunction(() => document.title.endsWith('rendered'), { timeout: 60000 });
  times.push(await page.evaluate(() => window.bonetkPage.frameTime));
  await browser.close();
}
const size = statSync(path).size;
rmSync(folder, { recursive: true });
const sorted = [...times].sort((a, b) => a - b);
console.log(`bundle ${script} bytes, ${packed} packed; page ${size} bytes`);
console.log(
  `first frame after ${times.map((time) => time.toFixed(0)).join(', ')} ms; median ${sorted[2].toFixed(0)} ms`
);
process.exit(sorted[2] <= 3000 && script <= 900e3 && packed <= 300e3 ? 0 : 1);
