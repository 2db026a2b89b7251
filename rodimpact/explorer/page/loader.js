"use strict";
// Unpacks the compressed script of the page, and runs it.

// Digits of base 85, from 0 to 84: those of Python's `b85encode`, with , in place of <.
const LETTERS =
  "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;,=>?@^_`{|}~";

/** Bytes of a text in base 85: five letters are four bytes, the last n letters n - 1. */
function bytesOf(text) {
  const missing = (5 - (text.length % 5)) % 5;
  const digits = text + "~".repeat(missing);
  const bytes = new DataView(new ArrayBuffer((digits.length / 5) * 4));
  for (let i = 0; i < digits.length; i += 5) {
    let value = 0;
    for (const letter of digits.slice(i, i + 5)) {
      value = 85 * value + LETTERS.indexOf(letter);
    }
    bytes.setUint32((i / 5) * 4, value);
  }
  return new Uint8Array(bytes.buffer, 0, bytes.byteLength - missing);
}

/** The text that was compressed. */
function unpack(text) {
  const packed = new Blob([bytesOf(text)]).stream();
  const unpacked = packed.pipeThrough(new DecompressionStream("deflate"));
  return new Response(unpacked).text();
}

unpack(document.getElementById("packed").textContent).then((text) => {
  const script = document.createElement("script");
  script.textContent = text;
  document.head.append(script);
});
