// Turning, moving and zooming the 3D view by mouse, touch and keys, without catching the page's own scrolling.

export const hint =
  'Drag to turn, drag with Shift or the right button to move. Wheel: zooms once the picture is clicked, or with Ctrl; ' +
  'Esc gives the wheel back to the page. Keys: arrows turn, Shift and arrows move, + and \u2212 zoom, 0 fits.';

/** Binds the canvas's events to a Scene; onTurn is called when the user has turned the view, onFit to fit it. */
export function bindInteraction(scene, { onTurn, onFit }) {
  const { canvas } = scene;
  const pointers = new Map();
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('pointerdown', (event) => {
    pointers.set(event.pointerId, event);
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) {
      return;
    }
    const right = event.clientX - before.clientX;
    const down = event.clientY - before.clientY;
    if (pointers.size === 2) {
      const other = [...pointers.values()].find((pointer) => pointer.pointerId !== event.pointerId);
      const spread = (pointer) => Math.hypot(pointer.clientX - other.clientX, pointer.clientY - other.clientY);
      scene.zoom(Math.max(1, spread(event)) / Math.max(1, spread(before)));
      scene.move(right / 2, down / 2);
    } else if (event.shiftKey || (event.buttons & 6) !== 0) {
      scene.move(right, down);
    } else {
      scene.turn(0.5 * right, 0.5 * down);
      onTurn();
    }
    pointers.set(event.pointerId, event);
  });
  for (const type of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(type, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    'wheel',
    (event) => {
      if (document.activeElement === canvas || event.ctrlKey) {
        event.preventDefault();
        scene.zoom(1.0015 ** -event.deltaY);
      }
    },
    { passive: false }
  );
  canvas.addEventListener('keydown', (event) => {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) {
      scene.move(20 * arrow[0], 20 * arrow[1]);
    } else if (arrow) {
      scene.turn(5 * arrow[0], 5 * arrow[1]);
      onTurn();
    } else if (event.key === '+' || event.key === '=') {
      scene.zoom(1.1);
    } else if (event.key === '-') {
      scene.zoom(1 / 1.1);
    } else if (event.key === '0') {
      onFit();
    } else if (event.key === 'Escape') {
      canvas.blur();
    } else {
      return;
    }
    event.preventDefault();
  });
}
