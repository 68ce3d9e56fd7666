// Elements and labelled controls.

/** An element with properties (and attributes, where the name holds a hyphen or is role or for) and children. */
export function element(name, properties = {}, ...children) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key.includes('-') || key === 'role' || key === 'for') {
      node.setAttribute(key, value);
    } else {
      node[key] = value;
    }
  }
  node.append(...children);
  return node;
}

/** A group of controls with a heading. */
export function group(title, ...children) {
  return element('fieldset', {}, element('legend', {}, title), ...children);
}

/** A select with its label; choices are pairs of value and text. */
export function select(id, label, choices, onChange) {
  const control = element('select', { id });
  control.append(...choices.map(([value, text]) => element('option', { value }, text)));
  control.addEventListener('change', () => onChange(control.value));
  return { control, row: element('div', { className: 'field' }, element('label', { for: id }, label), control) };
}

/** A checkbox with its label; further nodes of the row may follow. */
export function checkbox(id, label, checked, onChange) {
  const control = element('input', { type: 'checkbox', id, checked });
  control.addEventListener('change', () => onChange(control.checked));
  return { control, row: element('div', { className: 'check' }, control, element('label', { for: id }, label)) };
}

/**
 * A slider with its label and its value as text, which say(value) gives. live: whether screen readers also hear the
 * text when something else than the slider changes it. onInput hears of its user's moves alone.
 */
export function slider(id, label, { min, max, step, value, say, live = false }, onInput) {
  const control = element('input', { type: 'range', id, min, max, step });
  control.value = value;
  const output = element('output', { for: id, 'aria-live': live ? 'polite' : 'off' });
  const show = () => {
    const text = say(control.valueAsNumber);
    output.textContent = text;
    control.setAttribute('aria-valuetext', text);
  };
  show();
  control.addEventListener('input', () => {
    show();
    onInput(control.valueAsNumber);
  });
  const head = element('div', { className: 'field-head' }, element('label', { for: id }, label), output);
  return { control, output, show, row: element('div', { className: 'field' }, head, control) };
}

/** A button. */
export function button(text, onClick, properties = {}) {
  const control = element('button', { type: 'button', ...properties }, text);
  control.addEventListener('click', onClick);
  return control;
}

/** A function that calls `work` once before the next frame, however often it is called until then. */
export function oncePerFrame(work) {
  let waiting = false;
  return () => {
    if (!waiting) {
      waiting = true;
      requestAnimationFrame(() => {
        waiting = false;
        work();
      });
    }
  };
}
