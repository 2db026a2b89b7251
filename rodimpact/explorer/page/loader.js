"use strict";
// Unpacks the compressed script of the page, and runs it.

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const packed = new Blob([bytes]).stream();
  const unpacked = packed.pipeThrough(new DecompressionStream("deflate"));
  return new Response(unpacked).text();
}

unpack(document.getElementById("packed").textContent).then((text) => {
  const script = document.createElement("script");
  script.textContent = text;
  document.head.append(script);
});
