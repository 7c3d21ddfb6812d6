// A click on the picture of a robot starts its live page in the place of the picture.
document.addEventListener("click", (event) => {
  const link = event.target.closest("a.live");
  if (!link || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  const frame = document.createElement("iframe");
  frame.className = "live";
  frame.title = link.title;
  frame.src = link.href;
  link.replaceWith(frame);
});

// A click on a drawing shows it alone, as large as the window allows.
document.addEventListener("click", (event) => {
  const drawing = event.target.closest('article img[src$=".svg"]');
  if (drawing && !drawing.closest("a")) window.open(drawing.src, "_blank");
});
