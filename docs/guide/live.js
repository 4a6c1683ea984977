// In the book, what stands in a chapter as `roverlab.html#system` is there: the page of web/build.mjs, put beside the chapters.
for (const code of document.querySelectorAll("main code")) {
  if (!code.textContent.startsWith("roverlab.html#")) continue;
  const link = document.createElement("a"), frame = document.createElement("iframe");
  link.href = frame.src = code.textContent;
  link.target = "_blank";
  frame.title = "The robot, live";
  frame.loading = "lazy";
  frame.style = "width: 100%; height: 36rem; border: 1px solid var(--table-border-color, #ccc); border-radius: 6px";
  code.replaceWith(link);
  link.append(code);
  link.closest("p").after(frame);
}
