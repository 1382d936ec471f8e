// SPDX-License-Identifier: Apache-2.0
#include "domewarp/render/compare_page.h"

#include <array>
#include <cstdint>
#include <cstdio>
#include <span>
#include <sstream>

#include "domewarp/core/markup.h"
#include "domewarp/profile/plot.h"
#include "domewarp/render/canvas.h"

namespace domewarp {

namespace {

constexpr const char* style = R"(
:root { color-scheme: light dark; --line: #8885; --bad: #c22; --good: #293; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 1100px; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin: 2em 0 .5em; }
table { border-collapse: collapse; } td, th { padding: .25em .9em .25em 0; border-bottom: 1px solid var(--line); text-align: left; vertical-align: top; }
td.figure { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.good { color: var(--good); } td.bad { color: var(--bad); font-weight: bold; }
img { width: 100%; display: block; background: #000; }
figure { margin: 0; } figcaption { margin: .4em 0; opacity: .8; }
.curve svg { max-width: 100%; height: auto; background: #fff; }
.slider { position: relative; line-height: 0; }
.slider .over { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--at, 50%)) 0 0); }
.slider .bar { position: absolute; top: 0; bottom: 0; left: var(--at, 50%); width: 2px; margin-left: -1px; background: #fff; box-shadow: 0 0 3px #000; }
.slider input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0; cursor: ew-resize; }
.key { display: inline-block; width: .9em; height: .9em; vertical-align: -1px; border: 1px solid var(--line); margin: 0 .3em 0 .9em; }
)";

constexpr const char* script = R"(
const slider = document.getElementById('slider');
slider.querySelector('input').addEventListener('input', event => slider.style.setProperty('--at', event.target.value + '%'));
addEventListener('load', () => { // says that every picture is there
  document.documentElement.dataset.pictures = [...document.images].filter(picture => picture.naturalWidth > 0).length;
});
)";

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t rest = bytes.size() - i;
    const unsigned value = unsigned(bytes[i] << 16) | (rest > 1 ? unsigned(bytes[i + 1] << 8) : 0u) | (rest > 2 ? unsigned(bytes[i + 2]) : 0u);
    for (unsigned k = 0; k < 4; ++k) text += k <= rest ? digits[value >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string image(const Pixels& picture, int widest, const std::string& alt, const std::string& attributes = "") {
  const Pixels small = shrink(picture, widest);
  return "<img alt=\"" + escape_markup(alt) + "\" " + attributes + " src=\"data:image/png;base64," +
         base64(encode_png(small.width, small.height, 4, small.rgba)) + "\">";
}

std::string number(double value, const char* format = "%.4g") {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

class Table {
 public:
  /// @param judged "good" or "bad" colours the figure
  void row(const std::string& name, const std::string& figure, const std::string& note, const char* judged = "") {
    rows_ << "<tr><td>" << name << "</td><td class=\"figure " << judged << "\">" << figure << "</td><td>" << note << "</td></tr>\n";
  }
  std::string html() const { return "<table id=\"figures\">\n" + rows_.str() + "</table>\n"; }

 private:
  std::ostringstream rows_;
};

const char* judge(bool good) { return good ? "good" : "bad"; }

std::string at_seams(std::size_t count) { return count ? std::to_string(count) + " of them where the outlines of two pieces meet" : ""; }

std::string figures(const ComparePage& page, const CompareReport& report) {
  Table table;
  const DisplacementReport& d = report.displacement_px;
  if (d.measured) {
    table.row("displacement, largest", number(d.max) + " px", "at column " + std::to_string(d.worst_column) + ", row " + std::to_string(d.worst_row) +
              "; promised " + number(page.tolerance_px) + " px and one step of the rasteriser", judge(d.max <= page.bound_px));
    table.row("displacement, 99.9 % below", number(d.p999) + " px", "");
    table.row("displacement, rms", number(d.rms) + " px", std::to_string(d.measured) + " pixels measured");
  } else {
    table.row("displacement", "not measured", "the warped file has no _SOURCE_POSITION");
  }
  table.row("pinholes", std::to_string(report.pinholes), at_seams(report.pinholes_at_seams), judge(report.pinholes == report.pinholes_at_seams));
  table.row("hidden surfaces that show", std::to_string(report.surface_mismatch), at_seams(report.surface_mismatch_at_seams),
            judge(report.surface_mismatch == report.surface_mismatch_at_seams));
  if (report.overlaps) table.row("overlaps", std::to_string(*report.overlaps), "", judge(*report.overlaps == 0));
  table.row("differ at outlines", std::to_string(report.outline), "by no more than the bound");
  table.row("depth ties", std::to_string(report.depth_ties), "the other of two surfaces at the same depth");
  table.row("covered", std::to_string(report.coverage.both), "pixels in both; " + std::to_string(report.coverage.reference) + " traced, " +
            std::to_string(report.coverage.warped) + " rasterised");
  if (report.depth_rel.measured) table.row("depth, largest error", number(100 * report.depth_rel.max) + " %", "");
  table.row("PSNR", report.psnr_db ? number(*report.psnr_db) + " dB" : "equal", "");
  if (report.ssim) table.row("SSIM", number(*report.ssim), "1 is equal");
  table.row("FLIP, mean", number(report.flip.mean), "0 is equal; largest " + number(report.flip.max));
  return table.html();
}

std::string section(const std::string& title, const std::string& content) { return "<h2>" + title + "</h2>\n" + content + "\n"; }

std::string key(const char* colour, const char* text) {
  return std::string("<span class=\"key\" style=\"background:") + colour + "\"></span>" + text;
}

std::string slider(const ComparePage& page, int widest) {
  return "<div class=\"slider\" id=\"slider\">" + image(page.rasterised, widest, "rasterised from the warped file") +
         image(page.reference, widest, "ray-traced from the scene", "class=\"over\"") +
         "<div class=\"bar\"></div><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" step=\"0.1\" aria-label=\"which picture\"></div>"
         "<figcaption>Left of the line: ray-traced from the scene. Right: rasterised from the warped file. Drag.</figcaption>";
}

/// The display's drawing, without the namespace that only a file of its own needs.
std::string inline_svg(const Surface& surface) {
  std::string svg = plot_svg(surface);
  const std::string space = " xmlns=\"http://www.w3.org/2000/svg\"";
  if (const std::size_t at = svg.find(space); at != std::string::npos) svg.erase(at, space.size());
  return svg;
}

} // namespace

std::string compare_page(const ComparePage& page, const CompareReport& report, const Surface& surface, int widest) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>";
  const std::string title = escape_markup(page.warped) + " compared with " + escape_markup(page.scene);
  html += title + "</title>\n<style>" + style + "</style>\n</head>\n<body>\n<h1>" + title + "</h1>\n<p>" + std::to_string(page.rasterised.width) + " &times; " +
          std::to_string(page.rasterised.height) + " pixels, tolerance " + number(page.tolerance_px) + " px, rasterised by " + escape_markup(page.renderer) + ".</p>\n";
  html += section("Figures", figures(page, report));
  html += section("Both pictures", slider(page, widest));
  html += section("Displacement", image(page.displacement, widest, "displacement in pixels") + "<figcaption>Distance of everything from its exact place, scale below the picture." +
                  key("#ff00ff", "pinholes") + key("#fff", "hidden surfaces") + key("#808080", "not measured") + "</figcaption>");
  html += section("Cracks", image(page.cracks, widest, "crack map") + "<figcaption>" + key("#ff00ff", "pinholes") + key("#fff", "hidden surfaces") +
                  key("#ffe600", "overlaps") + key("#40a0ff", "depth ties") + "</figcaption>");
  html += section("Difference", image(page.difference, widest, "difference of the colours") + "<figcaption>Four times enlarged; magenta where only one picture is covered.</figcaption>");
  html += section("Wireframe", image(page.wireframe, widest, "edges of the triangles over the picture"));
  html += section("Display", "<div class=\"curve\">" + inline_svg(surface) + "</div>");
  return html + "<script>" + script + "</script>\n</body>\n</html>\n";
}

} // namespace domewarp
