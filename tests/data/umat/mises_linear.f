C     SPDX-License-Identifier: Apache-2.0
C     von Mises with linear isotropic hardening, radial return, in the
C     form of an Abaqus UMAT. PROPS: E, nu, yield stress, H. STATEV(1):
C     equivalent plastic strain.
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS),DRPLDE(NTENS),STRAN(NTENS),DSTRAN(NTENS),TIME(2),
     2 PREDEF(1),DPRED(1),PROPS(NPROPS),COORDS(3),DROT(3,3),
     3 DFGRD0(3,3),DFGRD1(3,3),JSTEP(4)
      DIMENSION XN(6)
      IF (NPROPS.NE.4) THEN
        WRITE(6,*) 'UMAT MISES_LINEAR: FOUR PROPERTIES WANTED'
        CALL XIT
      END IF
      G = PROPS(1)/(2.D0*(1.D0+PROPS(2)))
      XLAM = PROPS(1)*PROPS(2)/((1.D0+PROPS(2))*(1.D0-2.D0*PROPS(2)))
      DO J = 1, NTENS
        DO I = 1, NTENS
          DDSDDE(I,J) = 0.D0
          IF (I.LE.NDI .AND. J.LE.NDI) DDSDDE(I,J) = XLAM
        END DO
        IF (J.LE.NDI) DDSDDE(J,J) = XLAM + 2.D0*G
        IF (J.GT.NDI) DDSDDE(J,J) = G
      END DO
      DO I = 1, NTENS
        DO J = 1, NTENS
          STRESS(I) = STRESS(I) + DDSDDE(I,J)*DSTRAN(J)
        END DO
      END DO
      CALL SINV(STRESS,XMEAN,Q,NDI,NSHR)
      FLOW = PROPS(3) + PROPS(4)*STATEV(1)
      IF (Q.LE.FLOW) RETURN
      DP = (Q-FLOW)/(3.D0*G+PROPS(4))
      STATEV(1) = STATEV(1) + DP
      DO I = 1, NTENS
        XN(I) = STRESS(I)
        IF (I.LE.NDI) XN(I) = STRESS(I) - XMEAN
        XN(I) = XN(I)/Q
        STRESS(I) = STRESS(I) - 3.D0*G*DP*XN(I)
      END DO
C     2G(theta I_dev + ...) with n of length sqrt(2/3)
      THETA = 3.D0*G*DP/Q
      BAR = 1.5D0*(3.D0*G/(3.D0*G+PROPS(4)) - THETA)
      DO J = 1, NTENS
        DO I = 1, NTENS
          D = 0.D0
          IF (I.EQ.J .AND. I.LE.NDI) D = 1.D0
          IF (I.EQ.J .AND. I.GT.NDI) D = 0.5D0
          IF (I.LE.NDI .AND. J.LE.NDI) D = D - 1.D0/3.D0
          DDSDDE(I,J) = DDSDDE(I,J) - 2.D0*G*(THETA*D+BAR*XN(I)*XN(J))
        END DO
      END DO
      RETURN
      END
