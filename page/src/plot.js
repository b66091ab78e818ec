// The curve of a run: its numbers over its steps, and where the state that is shown stands.

class Plot {
  constructor(canvas, plot) {
    Object.assign(this, { canvas, plot, row: 0 });
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
  }

  mark(row) {
    this.row = row;
    this.draw();
  }

  draw() {
    const { canvas, plot } = this, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return;
    const ratio = Math.min(devicePixelRatio, 2), paper = canvas.getContext('2d');
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    paper.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement), color = (name) => style.getPropertyValue(name).trim();
    const placed = (y) => (plot.log ? Math.log10(y) : y);
    const good = plot.values.map((y) => y !== null && (!plot.log || y > 0));
    const heights = plot.values.filter((_, k) => good[k]).map(placed);
    if (!heights.length) return;
    let lo = Math.min(...heights), hi = Math.max(...heights);
    if (hi - lo < 1e-12 * Math.abs(hi) || hi === lo) {
      lo -= 0.5 * Math.abs(lo) || 0.5;
      hi += 0.5 * Math.abs(hi) || 0.5;
    }
    const left = 52, right = 10, top = 8, bottom = 20;
    const x = (k) => left + (width - left - right) * k / Math.max(1, plot.values.length - 1);
    const y = (value) => top + (height - top - bottom) * (hi - placed(value)) / (hi - lo);
    paper.font = '11px system-ui, sans-serif';
    paper.fillStyle = color('--quiet');
    paper.strokeStyle = color('--rule');
    const shown = (level) => (plot.log ? `1e${Math.round(level)}` : Number(level.toPrecision(3)).toString());
    for (const level of levels(lo, hi, plot.log)) {
      const at = top + (height - top - bottom) * (hi - level) / (hi - lo);
      paper.beginPath();
      paper.moveTo(left, at);
      paper.lineTo(width - right, at);
      paper.stroke();
      paper.textAlign = 'right';
      paper.fillText(shown(level), left - 6, at + 4);
    }
    paper.textAlign = 'center';
    paper.fillText('0', x(0), height - 5);
    if (plot.values.length > 1) paper.fillText(`${plot.x} ${plot.values.length - 1}`, Math.min(x(plot.values.length - 1), width - 30), height - 5);
    paper.strokeStyle = color('--accent');
    paper.lineWidth = 1.6;
    paper.beginPath();
    let isDown = false;
    plot.values.forEach((value, k) => {
      if (good[k]) isDown ? paper.lineTo(x(k), y(value)) : paper.moveTo(x(k), y(value));
      isDown = good[k];
    });
    paper.stroke();
    if (good[this.row]) {
      paper.fillStyle = color('--accent');
      paper.beginPath();
      paper.arc(x(this.row), y(plot.values[this.row]), 4.5, 0, 7);
      paper.fill();
    }
  }
}

/** Where lines stand: at powers of ten, or at round numbers. */
function levels(lo, hi, isLog) {
  const rough = (hi - lo) / 3;
  const ten = 10 ** Math.floor(Math.log10(rough));
  const step = isLog ? Math.max(1, Math.ceil(rough)) : [1, 2, 5, 10].map((k) => k * ten).find((size) => size >= rough);
  const levels = [];
  for (let k = Math.ceil(lo / step); k * step <= hi; k++) levels.push(k * step);
  return levels;
}
