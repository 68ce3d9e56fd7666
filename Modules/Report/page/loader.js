// Inflates the page's script, which the page holds as base64 of its gzip, and runs it. Nothing is fetched.
(async () => {
  const explain = (text) => {
    for (const id of ['viewer', 'slices', 'atlas']) {
      const element = document.getElementById(id);
      if (element && !element.hasChildNodes()) {
        element.className = 'notice';
        element.textContent = text;
      }
    }
  };
  const base64 = document.getElementById('bonetk-bundle')?.textContent.trim();
  if (!base64) {
    explain('This page holds no interactive view: BoneTK was built without npm. The tables and pictures are complete.');
    return;
  }
  try {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const inflated = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    const script = document.createElement('script');
    script.textContent = await new Response(inflated).text();
    document.head.append(script);
  } catch (error) {
    explain(
      'The interactive views need Chrome 80, Edge 80, Safari 16.4, Firefox 113 or a later version. The tables and ' +
        'pictures are complete. (' +
        error.message +
        ')'
    );
  }
})();
