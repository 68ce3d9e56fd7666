/*=========================================================================
 *  Copyright the BoneTK contributors. SPDX-License-Identifier: Apache-2.0
 *=========================================================================*/
#ifndef boneFiniteElementText_h
#define boneFiniteElementText_h

#include "boneFiniteElementModel.h"

#include <charconv>
#include <string>

namespace bone
{
/** \class FiniteElementText
 * \brief A text file that is made number by number. */
class FiniteElementText
{
public:
  FiniteElementText &
  operator<<(const char * text)
  {
    m_Text += text;
    return *this;
  }
  FiniteElementText &
  operator<<(const std::string & text)
  {
    m_Text += text;
    return *this;
  }
  FiniteElementText &
  operator<<(char c)
  {
    m_Text += c;
    return *this;
  }
  template <typename T, std::enable_if_t<std::is_arithmetic_v<T>, int> = 0>
  FiniteElementText &
  operator<<(T number)
  {
    char                 digits[32];
    std::to_chars_result end{};
    if constexpr (std::is_floating_point_v<T>)
    {
      end = std::to_chars(digits, digits + sizeof(digits), number, std::chars_format::general, 10);
    }
    else
    {
      end = std::to_chars(digits, digits + sizeof(digits), number);
    }
    m_Text.append(digits, end.ptr);
    return *this;
  }

  /** Numbers from 1, `each` on a line at the most, apart by commas. */
  FiniteElementText &
  AddIds(const std::vector<IdType> & ids, std::size_t each)
  {
    for (std::size_t i = 0; i < ids.size(); ++i)
    {
      const bool last = i + 1 == ids.size();
      *this << ids[i] + 1 << (last ? "\n" : (i + 1) % each == 0 ? ",\n" : ", ");
    }
    return *this;
  }

  /** The law, its source, range and units, and what the moduli are, a line each after `mark`. */
  void
  AddDescription(const FiniteElementModel & model, const std::string & mark, const std::string & end = "\n");

  const std::string &
  GetText() const
  {
    return m_Text;
  }

private:
  std::string m_Text;
};

std::string
AbaqusText(const FiniteElementModel & model);
std::string
FEBioText(const FiniteElementModel & model);
std::string
GmshText(const FiniteElementModel & model);
} // namespace bone

#endif
