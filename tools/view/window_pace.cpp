#include <view/window_pace.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace haarlight::view {
namespace {

// milliseconds that pictures may take
constexpr double when_moving = 60;
constexpr double when_still = 3000;

} // namespace

void Pace::next(bool moving, double full, int at_least) {
  if (m_steady)
    return;
  const bool moved =
      std::exchange(m_moving, moving); // hurried pictures do not tell what others take
  const int finer = (m_coarseness + 1) / 2;
  if (moving)
    m_coarseness =
        static_cast<int>(std::ceil(std::clamp(std::sqrt(full / when_moving), 1.0, 1.0 * coarsest)));
  else if (!moved && full <= when_still * finer * finer)
    m_coarseness = finer;
  m_coarseness = std::max(m_coarseness, at_least);
}

} // namespace haarlight::view
