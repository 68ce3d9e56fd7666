// Headless Chromium by puppeteer, which is found in the folder that BONETK_PAGE_MODULES names.
import { createRequire } from 'node:module';
import { join } from 'node:path';

/** Opens Chromium (BONETK_CHROMIUM), which draws WebGL without a graphics card. */
export async function openBrowser() {
  const puppeteer = createRequire(join(process.env.BONETK_PAGE_MODULES, 'package.json'))('puppeteer-core');
  return puppeteer.launch({
    executablePath: process.env.BONETK_CHROMIUM,
    headless: 'shell',
    args: [
      '--no-sandbox',
      '--use-gl=angle',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--ignore-gpu-blocklist'
    ]
  });
}
