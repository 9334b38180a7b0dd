#include <html/axis.h>

#include <html/text.h>

#include <algorithm>
#include <cmath>

namespace haarlight::html {

bool Axis::can_show(double value) const {
  return std::isfinite(value) && (value > 0 || scale == AxisScale::Linear);
}

void Axis::take(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

void Axis::finish() {
  if (high < low)
    low = high = 1;
  if (scale == AxisScale::Linear) {
    high += high > low ? 0 : 1;
    return;
  }
  const double room = std::max(1.12, std::pow(high / low, 0.04));
  low /= room;
  high *= room;
}

double Axis::place(double value) const {
  if (scale == AxisScale::Linear)
    return from + (to - from) * (value - low) / (high - low);
  return from + (to - from) * std::log(value / low) / std::log(high / low);
}

std::vector<double> Axis::ticks() const {
  std::vector<double> result;
  const bool dense = high / low < 100;
  for (double power = std::floor(std::log10(low)); power <= std::log10(high); ++power)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10, power);
      if ((dense || factor == 1) && value >= low && value <= high)
        result.push_back(value);
    }
  return result;
}

std::string Axis::tick_text(double value) const {
  if (scale == AxisScale::Linear)
    return std::to_string(std::lround(value)).append("°");
  if (value >= 1 && value < 99999)
    return std::to_string(std::lround(value));
  if (value >= 0.0099 && value < 1)
    return number_html(value);
  const double power = std::floor(std::log10(value) + 1e-9);
  const long factor = std::lround(value / std::pow(10, power));
  std::string text = factor == 1 ? std::string() : std::to_string(factor).append("·");
  return text.append("10<tspan dy=\"-5\" font-size=\"8\">")
      .append(std::to_string(std::lround(power)))
      .append("</tspan>");
}

} // namespace haarlight::html
