#include <html/frame.h>

#include <html/text.h>

namespace haarlight::html {
namespace {

constexpr const char* style = R"(<style>
body { font: 14px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
  color: #222; background: #fff; max-width: 1240px; margin: 32px auto; padding: 0 24px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 20px; margin: 40px 0 10px; }
h2 small { font-weight: 400; color: #777; } h3 { font-size: 15px; margin: 24px 0 8px; }
p, li { max-width: 860px; }
table { display: block; overflow-x: auto; border-collapse: collapse; font-size: 12.5px;
  font-variant-numeric: tabular-nums; margin-bottom: 12px; }
th { text-align: left; font-weight: 600; color: #555; padding: 3px 9px; vertical-align: bottom; }
th.group { text-align: center; border-bottom: 1px solid #bbb; }
td { padding: 3px 9px; border-top: 1px solid #e8e8e8; white-space: nowrap; }
td.n, th.n { text-align: right; } td.off { color: #c00020; font-weight: 600; }
tbody tr:hover { background: #f5f7fa; }
.swatch { vertical-align: middle; margin-right: 6px; }
.tag { font-size: 11px; color: #8a5a00; background: #fff1d6; border-radius: 3px; padding: 0 4px; }
.plots { display: grid; grid-template-columns: 1fr 1fr; gap: 12px; margin-bottom: 14px; }
.plots svg { width: 100%; font-size: 11.5px; }
.pictures { display: flex; flex-wrap: wrap; gap: 14px; }
figure { margin: 0; font-size: 12px; width: 128px; }
figure > img { display: block; image-rendering: pixelated; margin-bottom: 4px; background: #000; }
figcaption { line-height: 1.3; }
.legend { width: 128px; height: 128px; margin-bottom: 4px; color: #555; font-size: 10.5px;
  display: flex; flex-direction: column; justify-content: center; }
.legend img { width: 128px; height: 14px; }
.legend div { display: flex; justify-content: space-between; font-size: 9.5px; }
section { border-top: 2px solid #222; margin-top: 48px; } section h2 { margin-top: 14px; }
img.wide { max-width: 100%; image-rendering: pixelated; background: #000; }
table.values td { white-space: normal; } table.values th { white-space: nowrap; }
.maps figure { width: 384px; } .maps img { width: 384px; image-rendering: auto; }
sup { line-height: 0; } code { font-size: 92%; }
</style>
)";

} // namespace

std::string framed(const std::string& title, const std::string& body) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                     "<meta name=\"viewport\" content=\"width=device-width\">\n<title>";
  html.append(escaped(title)).append("</title>\n").append(style).append("</head>\n<body>\n");
  return html.append(body).append("</body>\n</html>\n");
}

} // namespace haarlight::html
