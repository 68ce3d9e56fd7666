// The CT's slices with their contours.
import { decodeArray, decodeJpeg, decodeJson } from './arrays.js';
import { checkbox, element, group, oncePerFrame, slider } from './dom.js';
import { colourBar, legend, ScaleBar } from './overlay.js';

/** The letters of the patient's directions at a picture's four sides. */
export function directionLetters(letters) {
  return ['left', 'right', 'top', 'bottom'].map((side) =>
    element('span', { className: `letter letter-${side}` }, letters[side] ?? '')
  );
}

/** A frame for a picture of columns x rows that is at most `height` high. */
export function pictureFrame(columns, rows, height, ...children) {
  const style = `aspect-ratio: ${columns} / ${rows}; width: min(100%, ${height} * ${columns / rows})`;
  return element('div', { className: 'picture', style }, ...children);
}

export class Slices {
  static async create(container, data) {
    const contours = await decodeJson(data.contours);
    const values = data.values.jpeg ? await decodeJpeg(data.values, data) : await decodeArray(data.values);
    return new Slices(container, { ...data, contours }, values);
  }

  constructor(container, data, values) {
    this.data = data;
    this.values = values;
    this.index = Math.floor(data.count / 2);
    [this.low, this.high] = data.window;
    this.hasContours = true;
    this.pixels = element('canvas', { width: data.columns, height: data.rows });
    this.canvas = element('canvas', {
      tabIndex: 0,
      role: 'img',
      'aria-label': 'CT slice; arrow keys go to the next one'
    });
    this.scaleBar = new ScaleBar();
    this.title = element('div', { className: 'picture-title', 'aria-live': 'polite' });
    this.barPlace = element('div');
    const names = new Map(data.contours.flat().map(({ name, color }) => [name, color]));
    this.frame = pictureFrame(
      data.columns,
      data.rows,
      '72vh',
      this.canvas,
      ...directionLetters(data.letters),
      this.scaleBar.node
    );
    container.className = 'viewer';
    container.append(
      element('div', { className: 'viewer-picture' }, this.title, this.frame, legend([...names]), this.barPlace),
      element('div', { className: 'controls' }, this.sliceGroup(), this.windowGroup(), this.contourGroup())
    );
    this.draw = oncePerFrame(() => this.drawNow());
    this.canvas.addEventListener('keydown', (event) => this.step(event));
    new ResizeObserver(() => this.draw()).observe(this.frame);
    this.show(this.index);
    this.showBar();
  }

  sliceGroup() {
    this.slider = slider(
      'slice',
      'Slice',
      { min: 0, max: this.data.count - 1, step: 1, value: this.index, say: (i) => `${i + 1} of ${this.data.count}` },
      (index) => this.show(index)
    );
    return group('Position', this.slider.row);
  }

  windowGroup() {
    const level = this.numberField('window-level', 'Level', (this.low + this.high) / 2);
    const width = this.numberField('window-width', 'Width', this.high - this.low);
    width.control.min = 1;
    for (const { control } of [level, width]) {
      control.addEventListener('input', () => {
        const [centre, extent] = [level.control.valueAsNumber, width.control.valueAsNumber];
        if (Number.isFinite(centre) && extent > 0) {
          [this.low, this.high] = [centre - extent / 2, centre + extent / 2];
          this.showBar();
          this.draw();
        }
      });
    }
    return group('Window', level.row, width.row);
  }

  numberField(id, label, value) {
    const control = element('input', { type: 'number', id, step: 10, value });
    const text = this.data.unit ? `${label} (${this.data.unit})` : label;
    return {
      control,
      row: element('div', { className: 'field field-inline' }, element('label', { for: id }, text), control)
    };
  }

  contourGroup() {
    const { row } = checkbox('slice-contours', 'Show contours', true, (isShown) => {
      this.hasContours = isShown;
      this.draw();
    });
    return group('Contours', row);
  }

  showBar() {
    const description = {
      quantity: this.data.unit === 'HU' ? 'CT number' : 'Density',
      unit: this.data.unit,
      range: [this.low, this.high]
    };
    this.barPlace.replaceChildren(colourBar(description, 'linear-gradient(to right, #000, #fff)'));
  }

  step(event) {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10 };
    if (event.key in steps) {
      event.preventDefault();
      this.show(this.index + steps[event.key]);
    }
  }

  show(index) {
    this.index = Math.min(this.data.count - 1, Math.max(0, index));
    this.slider.control.value = this.index;
    this.slider.show();
    this.title.textContent = this.data.titles[this.index];
    this.draw();
  }

  /** The slice's grey values into its own canvas, a pixel each. */
  drawPixels() {
    const { columns, rows } = this.data;
    const context = this.pixels.getContext('2d');
    const image = context.createImageData(columns, rows);
    const begin = this.index * columns * rows;
    const scale = 255 / (this.high - this.low);
    for (let i = 0; i < columns * rows; ++i) {
      image.data.fill((this.values[begin + i] - this.low) * scale, 4 * i, 4 * i + 3);
      image.data[4 * i + 3] = 255;
    }
    context.putImageData(image, 0, 0);
  }

  drawNow() {
    const { width, height } = this.frame.getBoundingClientRect();
    if (!(width > 0)) {
      return;
    }
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.drawPixels();
    const context = this.canvas.getContext('2d');
    context.imageSmoothingQuality = 'high';
    context.drawImage(this.pixels, 0, 0, this.canvas.width, this.canvas.height);
    if (this.hasContours) {
      const scale = this.canvas.width / this.data.columns;
      this.data.contours[this.index].forEach((contour) => drawContour(context, contour, scale, 1.5 * ratio));
    }
    this.scaleBar.update((this.data.pixel * this.data.columns) / width, width);
  }
}

/** Draws a contour in pixels, (0, 0) the centre of the upper left one. */
function drawContour(context, { points, closed, color }, scale, lineWidth) {
  context.beginPath();
  for (let i = 0; i < points.length; i += 2) {
    context.lineTo((points[i] + 0.5) * scale, (points[i + 1] + 0.5) * scale);
  }
  if (closed) {
    context.closePath();
  }
  context.strokeStyle = color;
  context.lineWidth = lineWidth;
  context.lineJoin = 'round';
  context.stroke();
}
