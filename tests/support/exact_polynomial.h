/// Polynomials with whole coefficients and their real roots in [0, 1], without rounding.
#pragma once

#include "support/exact.h"

namespace oilskin::exact {

Polynomial operator+(const Polynomial& f, const Polynomial& g);
Polynomial operator-(const Polynomial& f, const Polynomial& g);
Polynomial operator*(const Polynomial& f, const Polynomial& g);
/// Removes leading zeros.
void trim(Polynomial* f);
Polynomial derivative(const Polynomial& f);

/// The number n / 2^k.
struct Dyadic {
  Integer n;
  int k = 0;
};

/// A real number: the only root of the square-free f in the open interval (n / 2^k, (n + 1) / 2^k), or n /
/// 2^k itself.
struct Root {
  Polynomial f;
  Dyadic at;
  bool dyadic = false;
  int sign_before = 0;

  void refine();
};

int sign_at(const Polynomial& f, const Dyadic& t);
/// Signs of the Bernstein coefficients of f on [n / 2^k, (n + 1) / 2^k], the last end first.
std::vector<int> bernstein_signs(const Polynomial& f, const Dyadic& t);
/// All roots in [0, 1] of a polynomial that is not zero.
std::vector<Root> roots_of(const Polynomial& polynomial);
/// Sign of g at a root; refines the root as far as needed.
int sign_at_root(const Polynomial& g, Root* root);

}  // namespace oilskin::exact
