// What stands over or beside a picture: scale bar and colour bar.
import { densityGradient } from './colours.js';
import { element } from './dom.js';
import { formatNumber, roundStep, ticks } from './numbers.js';

/**
 * A scale bar of 1, 2 or 5 times a power of ten mm, at most a quarter of the picture wide. Its length is a share of the
 * picture's width, so that it holds in print too.
 */
export class ScaleBar {
  constructor() {
    this.text = element('span');
    this.node = element('div', { className: 'scale-bar' }, this.text);
  }

  update(millimetresPerPixel, width) {
    const length = roundStep(millimetresPerPixel * Math.max(40, width / 4));
    this.node.style.width = `${((100 * length) / (millimetresPerPixel * width)).toFixed(3)}%`;
    this.text.textContent = `${length} mm`;
  }
}

/**
 * A horizontal colour bar with numbers, quantity and unit. gradient: a CSS gradient from left to right, the density's
 * colours by default.
 */
export function colourBar({ quantity, unit, range }, gradient = densityGradient()) {
  const { values, decimals } = ticks(range, 5);
  const marks = values.map((value) => {
    const share = range[1] > range[0] ? (value - range[0]) / (range[1] - range[0]) : 0.5;
    const end = share < 0.03 ? ' tick-first' : share > 0.97 ? ' tick-last' : '';
    return element(
      'span',
      { className: `tick${end}`, style: `left: ${(100 * share).toFixed(2)}%` },
      formatNumber(value, decimals)
    );
  });
  return element(
    'div',
    { className: 'colour-bar' },
    element('div', { className: 'colour-bar-title' }, unit && unit !== quantity ? `${quantity} (${unit})` : quantity),
    element('div', { className: 'colour-bar-strip', style: `background: ${gradient}` }),
    element('div', { className: 'colour-bar-ticks' }, ...marks)
  );
}

/** Names beside their colours: entries are pairs of name and CSS colour. */
export function legend(entries) {
  return element(
    'ul',
    { className: 'legend' },
    ...entries.map(([name, colour]) =>
      element('li', {}, element('span', { className: 'swatch', style: `background: ${colour}` }), name)
    )
  );
}
