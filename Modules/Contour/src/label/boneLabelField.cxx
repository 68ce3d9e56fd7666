/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#include "boneLabelField.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace bone
{
namespace
{
constexpr float Unreached = 1e18F;

// Lines of a box of voxels along an axis.
struct Lines
{
  Lines(const std::array<int, 3> & size, int axis)
    : length(size[static_cast<std::size_t>(axis)])
  {
    const auto x = static_cast<std::size_t>(size[0]);
    const auto y = static_cast<std::size_t>(size[1]);
    const auto z = static_cast<std::size_t>(size[2]);
    stride = axis == 0 ? 1 : axis == 1 ? x : x * y;
    inner = axis == 0 ? y : x;
    innerStride = axis == 0 ? x : 1;
    outer = axis == 2 ? y : z;
    outerStride = axis == 2 ? x : x * y;
  }

  int         length;
  std::size_t stride;
  std::size_t inner;
  std::size_t innerStride;
  std::size_t outer;
  std::size_t outerStride;
};

// Lower envelope of parabolas: squared distances along one line, values[i] -> min over j of values[j] + (h (i - j))^2.
class Envelope
{
public:
  explicit Envelope(int length)
    : m_Values(static_cast<std::size_t>(length))
    , m_Vertex(static_cast<std::size_t>(length))
    , m_Start(static_cast<std::size_t>(length) + 1)
  {}

  void
  Run(float * values, std::size_t stride, int length, double h)
  {
    const double h2 = h * h;
    int          count = 0;
    for (int i = 0; i < length; ++i)
    {
      const double f = values[static_cast<std::size_t>(i) * stride];
      m_Values[static_cast<std::size_t>(i)] = f;
      if (f >= Unreached)
      {
        continue;
      }
      double start = -1e30;
      while (count > 0)
      {
        const int    v = m_Vertex[static_cast<std::size_t>(count - 1)];
        const double g = m_Values[static_cast<std::size_t>(v)];
        start = ((f - g) / h2 + (static_cast<double>(i) * i - static_cast<double>(v) * v)) / (2.0 * (i - v));
        if (start > m_Start[static_cast<std::size_t>(count - 1)])
        {
          break;
        }
        --count;
        start = -1e30;
      }
      m_Vertex[static_cast<std::size_t>(count)] = i;
      m_Start[static_cast<std::size_t>(count)] = start;
      ++count;
    }
    for (int i = 0, k = 0; i < length && count > 0; ++i)
    {
      while (k + 1 < count && m_Start[static_cast<std::size_t>(k + 1)] < i)
      {
        ++k;
      }
      const int v = m_Vertex[static_cast<std::size_t>(k)];
      values[static_cast<std::size_t>(i) * stride] =
        static_cast<float>(m_Values[static_cast<std::size_t>(v)] + h2 * (i - v) * (i - v));
    }
  }

private:
  std::vector<double> m_Values;
  std::vector<int>    m_Vertex;
  std::vector<double> m_Start;
};

template <typename TBody>
void
ForEachLine(const Lines & lines, const Execution & execution, TBody && body)
{
  execution.For(lines.outer, [&lines, &body](std::size_t o) {
    auto work = body.Begin(lines.length);
    for (std::size_t i = 0; i < lines.inner; ++i)
    {
      body.Run(work, o * lines.outerStride + i * lines.innerStride);
    }
  });
}

struct DistanceBody
{
  std::vector<float> & values;
  const Lines &        lines;
  double               spacing;

  Envelope
  Begin(int length) const
  {
    return Envelope(length);
  }
  void
  Run(Envelope & envelope, std::size_t first) const
  {
    envelope.Run(values.data() + first, lines.stride, lines.length, spacing);
  }
};

struct SmoothBody
{
  std::vector<float> &       values;
  const Lines &              lines;
  const std::vector<float> & half;

  std::vector<float>
  Begin(int length) const
  {
    return std::vector<float>(static_cast<std::size_t>(length) + 2 * (half.size() - 1));
  }
  void
  Run(std::vector<float> & line, std::size_t first) const
  {
    const int radius = static_cast<int>(half.size()) - 1;
    for (int i = -radius; i < lines.length + radius; ++i)
    {
      const auto at = static_cast<std::size_t>(std::clamp(i, 0, lines.length - 1));
      line[static_cast<std::size_t>(i + radius)] = values[first + at * lines.stride];
    }
    for (int i = 0; i < lines.length; ++i)
    {
      const float * at = line.data() + i + radius;
      float         sum = half[0] * at[0];
      for (int r = 1; r <= radius; ++r)
      {
        sum += half[static_cast<std::size_t>(r)] * (at[-r] + at[r]);
      }
      values[first + static_cast<std::size_t>(i) * lines.stride] = sum;
    }
  }
};

// Squared distance to the nearest voxel whose flag equals `feature`.
std::vector<float>
SquaredDistances(const VoxelBox &                   box,
                 const std::vector<unsigned char> & inside,
                 bool                               feature,
                 const Execution &                  execution)
{
  std::vector<float> values(inside.size());
  std::transform(inside.begin(), inside.end(), values.begin(), [feature](unsigned char flag) {
    return (flag != 0) == feature ? 0.0F : Unreached;
  });
  for (int axis = 0; axis < 3; ++axis)
  {
    const Lines lines(box.size, axis);
    ForEachLine(lines, execution.Part(axis / 3.0, (axis + 1) / 3.0), DistanceBody{ values, lines, box.spacing[axis] });
  }
  return values;
}

std::vector<float>
GaussianKernel(double sigma)
{
  const int          radius = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<float> half(static_cast<std::size_t>(radius) + 1);
  double             sum = 0.0;
  for (int r = 0; r <= radius; ++r)
  {
    half[static_cast<std::size_t>(r)] = static_cast<float>(std::exp(-0.5 * r * r / (sigma * sigma)));
    sum += (r == 0 ? 1.0 : 2.0) * half[static_cast<std::size_t>(r)];
  }
  for (float & w : half)
  {
    w = static_cast<float>(w / sum);
  }
  return half;
}
} // namespace

LabelField::LabelField(const VoxelBox &                   box,
                       const std::vector<unsigned char> & inside,
                       double                             sigma,
                       const Execution &                  execution)
  : m_Box(box)
  , m_ToIndex(box.spacing.cwiseInverse().asDiagonal() * box.direction.inverse())
  , m_Inside(inside.size())
{
  std::transform(
    inside.begin(), inside.end(), m_Inside.begin(), [](unsigned char flag) -> unsigned char { return flag != 0; });
  // A voxel of the sign's other side is at least this far away; half of it is the distance to the surface between.
  const double             step = box.spacing.minCoeff();
  const std::vector<float> toOutside = SquaredDistances(box, inside, false, execution.Part(0.0, 0.4));
  m_Values = SquaredDistances(box, inside, true, execution.Part(0.4, 0.8));
  for (std::size_t n = 0; n < m_Values.size(); ++n)
  {
    const double squared = inside[n] != 0 ? toOutside[n] : m_Values[n];
    const double distance = std::min(std::sqrt(squared), 1e6) - 0.5 * step;
    m_Values[n] = static_cast<float>(inside[n] != 0 ? distance : -distance);
  }
  if (sigma > 0.0)
  {
    const std::vector<float> half = GaussianKernel(sigma);
    for (int axis = 0; axis < 3; ++axis)
    {
      const Lines lines(box.size, axis);
      ForEachLine(
        lines, execution.Part(0.8 + axis / 15.0, 0.8 + (axis + 1) / 15.0), SmoothBody{ m_Values, lines, half });
    }
  }
  const auto least = static_cast<float>(0.15 * step);
  for (std::size_t n = 0; n < m_Values.size(); ++n)
  {
    m_Values[n] = inside[n] != 0 ? std::max(m_Values[n], least) : std::min(m_Values[n], -least);
  }
}

Vector3
LabelField::ToIndex(const Vector3 & p) const
{
  return m_ToIndex * (p - m_Box.origin);
}

template <typename TValue>
double
LabelField::Interpolate(const std::vector<TValue> & values, const Vector3 & x) const
{
  int    base[3];
  double t[3];
  for (int a = 0; a < 3; ++a)
  {
    const double last = m_Box.size[static_cast<std::size_t>(a)] - 1.0;
    const double c = std::clamp(x[a], 0.0, last);
    base[a] = std::min(static_cast<int>(c), std::max(0, static_cast<int>(last) - 1));
    t[a] = c - base[a];
  }
  const auto     nx = static_cast<std::size_t>(m_Box.size[0]);
  const auto     nxy = nx * static_cast<std::size_t>(m_Box.size[1]);
  const TValue * v = values.data() + static_cast<std::size_t>(base[0]) + nx * static_cast<std::size_t>(base[1]) +
                     nxy * static_cast<std::size_t>(base[2]);
  // A step of 0 where the box is one voxel thick.
  const std::size_t dx = m_Box.size[0] > 1 ? 1 : 0;
  const std::size_t dy = m_Box.size[1] > 1 ? nx : 0;
  const std::size_t dz = m_Box.size[2] > 1 ? nxy : 0;
  const auto        line = [&](std::size_t at) { return (1.0 - t[0]) * v[at] + t[0] * v[at + dx]; };
  const auto        face = [&](std::size_t at) { return (1.0 - t[1]) * line(at) + t[1] * line(at + dy); };
  return (1.0 - t[2]) * face(0) + t[2] * face(dz);
}

double
LabelField::Beyond(const Vector3 & x) const
{
  double beyond = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    const double c = std::clamp(x[a], 0.0, m_Box.size[static_cast<std::size_t>(a)] - 1.0);
    beyond = std::max(beyond, (std::abs(x[a] - c) - 0.5) * m_Box.spacing[a]);
  }
  return beyond > 1e-9 ? beyond : 0.0;
}

double
LabelField::Sample(const Vector3 & p) const
{
  const Vector3 x = this->ToIndex(p);
  const double  beyond = this->Beyond(x);
  const double  value = this->Interpolate(m_Values, x);
  return beyond > 0.0 ? std::min(value, -beyond) : value;
}

PlaneField
LabelField::SamplePlane(const PlaneGrid & grid, const Vector3 & u, const Vector3 & v, double height) const
{
  PlaneField    field{ grid, std::vector<float>(grid.Count()) };
  const Vector3 base = height * u.cross(v);
  for (int j = 0; j < grid.size[1]; ++j)
  {
    for (int i = 0; i < grid.size[0]; ++i)
    {
      const Vector2 q = grid.Node(i, j);
      field.values[grid.Offset(i, j)] = static_cast<float>(this->Sample(base + q.x() * u + q.y() * v));
    }
  }
  return field;
}

double
LabelField::LabelArea(const PlaneGrid & grid, const Vector3 & u, const Vector3 & v, double height) const
{
  double        sum = 0.0;
  const Vector3 base = height * u.cross(v);
  for (int j = 0; j < grid.size[1]; ++j)
  {
    for (int i = 0; i < grid.size[0]; ++i)
    {
      const Vector2 q = grid.Node(i, j);
      const Vector3 x = this->ToIndex(base + q.x() * u + q.y() * v);
      sum += this->Beyond(x) > 0.0 ? 0.0 : this->Interpolate(m_Inside, x);
    }
  }
  return sum * grid.spacing.x() * grid.spacing.y();
}
} // namespace bone
