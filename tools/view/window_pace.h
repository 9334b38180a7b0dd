#pragma once
// How fine a window's pictures are drawn.

namespace haarlight::view {

/// What is moved is followed at once by coarse pictures; when it rests they become finer step by
/// step, as far as there is time for it.
class Pace {
public:
  /// @param steady pictures are always of full resolution
  explicit Pace(bool steady) : m_steady(steady), m_coarseness(steady ? 1 : coarsest) {}

  /// Before the pictures are drawn.
  /// @param moving   whether anything is moved
  /// @param full     what pictures of full resolution would take, ms, by what the last ones took
  /// @param at_least coarseness that is wished for
  void next(bool moving, double full, int at_least);

  /// Of the window's pixels, along a side of one of a picture's.
  int coarseness() const { return m_coarseness; }
  /// Whether time counts more than looks.
  bool hurried() const { return m_moving; }

private:
  static constexpr int coarsest = 8;

  bool m_steady;
  bool m_moving = false;
  int m_coarseness;
};

} // namespace haarlight::view
